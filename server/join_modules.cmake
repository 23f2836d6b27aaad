# Makes one script of ES modules: cmake -DFILES=a.js;b.js -DOUTPUT=c.js -P join_modules.cmake
# Imports go, and with "export" before a declaration the word: in one scope every name is there already. FILES is in an order in which
# each module comes after those that it imports. Names at the top of a module are therefore unique among all of them.
set(joined "")
foreach(file ${FILES})
  file(READ ${file} content)
  # Neither brackets nor semicolons of JavaScript may look like those of a CMake list: no list is made of the content.
  string(REGEX REPLACE "(^|\n)import [^\n]*" "\\1" content "${content}")
  string(REGEX REPLACE "(^|\n)export " "\\1" content "${content}")
  string(APPEND joined "${content}")
endforeach()
file(WRITE ${OUTPUT} "${joined}")
