# Debian packages by CPack, a component each: the program (runtime), the library (dev), the Python
# module (python).
# `cmake --workflow --preset deb` makes them.
if(NOT SWIVEL_DEB)
  return()
endif()
find_program(SWIVEL_SHLIBDEPS dpkg-shlibdeps DOC "of Debian's package dpkg-dev" REQUIRED)
find_program(SWIVEL_HELP2MAN help2man DOC "of Debian's package help2man" REQUIRED)
if(NOT TARGET swivel_python)
  message(FATAL_ERROR "SWIVEL_DEB: the Python module is not built: allowed is SWIVEL_PYTHON=ON")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL runtime dev python)
set(CPACK_PACKAGE_CONTACT "The Swivel authors <swivel@swivel.invalid>" CACHE STRING
  "Name and address of the maintainer of Debian packages")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # CPack would put it before each description
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ
  GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# The date of the release is that of CHANGELOG.md.
set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND
  PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md)
file(READ ${PROJECT_SOURCE_DIR}/CHANGELOG.md text)
if(NOT text MATCHES "\n## \\[${PROJECT_VERSION}\\] - ([0-9-]+)\n")
  message(FATAL_ERROR "CHANGELOG.md has no heading '## [${PROJECT_VERSION}] - YYYY-MM-DD'")
endif()
execute_process(COMMAND date --utc --rfc-email --date=${CMAKE_MATCH_1} OUTPUT_VARIABLE date
  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

# swivel_deb(COMPONENT PACKAGE SECTION DESCRIPTION [DEPENDS]): first line of the description is the
# synopsis.
function(swivel_deb component package section description)
  string(TOUPPER ${component} prefix)
  set(CPACK_DEBIAN_${prefix}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${prefix}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${prefix}_DESCRIPTION "${description}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${prefix}_PACKAGE_DEPENDS "${ARGN}" PARENT_SCOPE)
  set(folder ${PROJECT_BINARY_DIR}/deb/${package})
  file(WRITE ${folder}/changelog
    "swivel (${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) bookworm; urgency=medium\n\n"
    "  * Release ${PROJECT_VERSION}, see changelog.gz.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  foreach(pair IN ITEMS ${folder}/changelog:changelog.Debian.gz
    ${PROJECT_SOURCE_DIR}/CHANGELOG.md:changelog.gz)
    string(REPLACE ":" ";" pair ${pair})
    list(GET pair 0 from)
    list(GET pair 1 to)
    execute_process(COMMAND gzip -9 -n -c ${from} OUTPUT_FILE ${folder}/${to}
      COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  set(documents ${CMAKE_INSTALL_DATADIR}/doc/${package})
  install(FILES ${folder}/changelog.Debian.gz ${folder}/changelog.gz DESTINATION ${documents}
    COMPONENT ${component})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${documents} RENAME copyright
    COMPONENT ${component})
endfunction()

swivel_deb(runtime swivel science "Tool paths into joint trajectories for redundant arms
Plans joint trajectories for arms whose tool must follow a given path of
poses: welding, polishing, sealing, inspection. It says why where there is no
path, finds where the part should stand, refines and times trajectories, and
checks those of others. /usr/share/swivel holds robots and problems to try.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)

swivel_deb(dev libswivel-dev libdevel "\
Tool paths into joint trajectories for redundant arms (library)
Headers and static libraries, found by find_package(swivel) of CMake and by
pkg-config."
  # What swivelConfig.cmake finds for static libraries.
  "libeigen3-dev, libfcl-dev, libtbb-dev, libtinyxml2-dev, libyaml-cpp-dev, zlib1g-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS libboost-dev)

get_directory_property(minor DIRECTORY ${PROJECT_SOURCE_DIR}/python DEFINITION Python_VERSION_MINOR)
math(EXPR next "${minor} + 1")
swivel_deb(python python3-swivel python "\
Tool paths into joint trajectories for redundant arms (Python)
The planner as the Python module swivel: robots, scenes, tasks, plans and
checks, with numpy arrays in and out."
  "python3 (>= 3.${minor}), python3 (<< 3.${next}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)

set(manual ${PROJECT_BINARY_DIR}/deb/swivel.1)
add_custom_command(OUTPUT ${manual}.gz
  COMMAND ${SWIVEL_HELP2MAN} --no-info --help-option=--help-all --version-string=${PROJECT_VERSION}
    --name=${PROJECT_DESCRIPTION} --output=${manual} $<TARGET_FILE:swivel>
  COMMAND gzip -9 -n -f ${manual} DEPENDS swivel VERBATIM)
add_custom_target(swivel_manual ALL DEPENDS ${manual}.gz)
install(FILES ${manual}.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)

include(CPack)
