# Makes one script of ES modules: cmake -DFILES=a.js;b.js -DOUTPUT=c.js -P join_modules.cmake
# It removes the imports, and the word "export" before declarations, because all names are in one scope. FILES must list
# each module after those that it imports. Names at the top of a module must be unique among all modules.
set(joined "")
foreach(file ${FILES})
  file(READ ${file} content)
  # The content is never a CMake list, so that brackets and semicolons of JavaScript have no meaning to CMake.
  string(REGEX REPLACE "(^|\n)import [^\n]*" "\\1" content "${content}")
  string(REGEX REPLACE "(^|\n)export " "\\1" content "${content}")
  string(APPEND joined "${content}")
endforeach()
file(WRITE ${OUTPUT} "${joined}")
