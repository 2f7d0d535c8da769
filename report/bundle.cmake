# Bundles the pages of report/web into FOLDER: report.html, overview.html, placements.html,
# THIRD-PARTY.txt. npm runs when the pinned packages have changed. Where that fails and REPORT is
# AUTO, the pages are left empty: the planner is built all the same, without --report.
set(web ${CMAKE_CURRENT_LIST_DIR}/web)
set(results ${FOLDER}/report.html ${FOLDER}/overview.html ${FOLDER}/placements.html
  ${FOLDER}/THIRD-PARTY.txt)
file(MAKE_DIRECTORY ${FOLDER})

function(run what)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${FOLDER} TIMEOUT 300 RESULT_VARIABLE code)
  if(code EQUAL 0)
    return()
  endif()
  if(NOT REPORT STREQUAL "AUTO")
    file(REMOVE ${results})
    message(FATAL_ERROR "${what} failed (${code})")
  endif()
  message("${what} failed (${code}): built without the pages of --report; "
    "to try again, remove ${FOLDER}/report.html")
  foreach(result IN LISTS results)
    file(WRITE ${result} "")
  endforeach()
  # Names a source, since ninja takes an empty list for one that is missing, and would try again
  # each time.
  string(REPLACE " " "\\ " rule "${FOLDER}/report.html: ${web}/build.mjs")
  string(REPLACE ":\\ " ": " rule "${rule}")
  file(WRITE ${FOLDER}/bundle.d "${rule}\n")
  set(failed TRUE PARENT_SCOPE)
endfunction()

# The copy of the lock file is made last, so it tells which packages lie there.
file(SHA256 ${web}/package-lock.json wanted)
set(present none)
if(EXISTS ${FOLDER}/packages.lock)
  file(READ ${FOLDER}/packages.lock present)
endif()
if(NOT present STREQUAL wanted)
  file(REMOVE ${FOLDER}/packages.lock)
  file(COPY ${web}/package.json ${web}/package-lock.json DESTINATION ${FOLDER})
  run("npm ci" ${NPM} ci --no-audit --no-fund --fetch-retries=1 --fetch-retry-mintimeout=2000)
  if(failed)
    return()
  endif()
  file(WRITE ${FOLDER}/packages.lock ${wanted})
endif()
run("bundling the pages" ${NODE} ${web}/build.mjs ${FOLDER})
