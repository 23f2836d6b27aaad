# Installs the packages that a package-lock.json pins: cmake -DSOURCE=folder -DOUTPUT=folder -DFOR=what -P npm_packages.cmake
# Afterwards OUTPUT/installed exists. If npm or its registry is not available, the build does not fail: the script says what
# will be missing, and the next build tries again if it matters. Packages that were installed for the same lock are kept.
file(READ ${SOURCE}/package-lock.json wanted)
set(have "")
if(EXISTS ${OUTPUT}/package-lock.json AND EXISTS ${OUTPUT}/node_modules)
  file(READ ${OUTPUT}/package-lock.json have)
endif()
if(NOT have STREQUAL wanted)
  file(REMOVE_RECURSE ${OUTPUT}/node_modules)
  file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json DESTINATION ${OUTPUT})
  find_program(NPM npm)
  set(failed "npm is not installed")
  if(NPM)
    execute_process(COMMAND ${NPM} ci --prefer-offline --ignore-scripts --no-audit --no-fund WORKING_DIRECTORY ${OUTPUT}
                    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE said)
  endif()
  if(failed)
    file(REMOVE_RECURSE ${OUTPUT}/node_modules)
    file(REMOVE ${OUTPUT}/package-lock.json)
    message(WARNING "The packages of ${SOURCE}/package.json could not be installed (${failed}). The build goes on without ${FOR}. "
                    "Install npm (tools/setup does), see that its registry can be reached, and build again after: rm -r ${OUTPUT}\n${said}")
  endif()
endif()
file(WRITE ${OUTPUT}/installed "")
