# Three.js as modules that carry its licence: cmake -DPACKAGES=folder -DOUTPUT=folder -P three_modules.cmake
# If the package is missing, it writes an empty module instead, and the page says so.
set(package ${PACKAGES}/node_modules/three)
foreach(name three.core.js three.module.js)
  if(EXISTS ${package}/build/${name})
    file(READ ${package}/LICENSE licence)
    file(READ ${package}/build/${name} text)
    file(WRITE ${OUTPUT}/${name} "/*\n${licence}*/\n${text}")
  else()
    file(WRITE ${OUTPUT}/${name} "export const REVISION = \"\";\n")
  endif()
endforeach()
