option(BUILD_SHARED_LIBS "Build the components as shared libraries" OFF)
option(SWIVEL_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(SWIVEL_BENCH "Build the benchmarks" OFF)
option(SWIVEL_WERROR "Treat warnings as errors" OFF)
option(SWIVEL_DEB "Make Debian packages by CPack: needs dpkg-dev and help2man" OFF)
option(SWIVEL_FRAME_POINTERS "Keep frame pointers, for profilers" OFF)
option(SWIVEL_PRECOMPILE "Precompile the headers that most sources include" ON)
option(SWIVEL_ROOMS_AT_ONCE "Compile all sources of a folder in one go: from scratch sooner" ON)
set(SWIVEL_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
# A package found by one component must be seen where that component is linked.
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
include(${CMAKE_CURRENT_LIST_DIR}/public_headers.cmake)

if(PROJECT_IS_TOP_LEVEL AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(SWIVEL_CCACHE ccache)
  mark_as_advanced(SWIVEL_CCACHE)
  if(SWIVEL_CCACHE)
    # ccache passes over sources with precompiled headers unless it is told that their macros and
    # times of files do not matter here (ccache's manual, "Precompiled headers").
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
        CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
        ${SWIVEL_CCACHE})
  endif()
endif()

# Compile settings of every target of the project, and of nobody else.
add_library(swivel_settings INTERFACE)
# No contraction: the same bits with and without FMA, so that every vector unit gives the same
# answer.
# No errno, no trapping: neither changes a value, both are needed to vectorise sqrt and selects.
# GCC 12 warns of overlaps inside std::string that are not there (-Wrestrict). An initialiser with
# names of members leaves the others at their defaults on purpose.
target_compile_options(swivel_settings
  INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wno-missing-field-initializers
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
  target_compile_options(swivel_settings INTERFACE -fpch-preprocess)
endif()
if(SWIVEL_WERROR)
  target_compile_options(swivel_settings INTERFACE -Werror)
endif()
if(SWIVEL_FRAME_POINTERS)
  target_compile_options(swivel_settings
    INTERFACE -fno-omit-frame-pointer -mno-omit-leaf-frame-pointer)
endif()
if(SWIVEL_SANITIZE)
  target_compile_options(swivel_settings
    INTERFACE -fsanitize=${SWIVEL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(swivel_settings INTERFACE -fsanitize=${SWIVEL_SANITIZE})
endif()

# Headers of the standard library and of Eigen that nearly every source includes.
set(SWIVEL_COMMON_HEADERS <Eigen/Geometry> <Eigen/LU> <algorithm> <array> <atomic> <cmath>
  <cstdint> <cstdio> <filesystem> <functional> <map> <memory> <mutex> <numeric> <optional> <span>
  <sstream> <stdexcept> <string> <string_view> <thread> <unordered_map> <utility> <variant>
  <vector>)

# swivel_precompile(TARGET <header> ...): compiles these headers once for all sources of the target.
# Sources still include what they use:
# SWIVEL_PRECOMPILE=OFF builds without.
function(swivel_precompile target)
  if(SWIVEL_PRECOMPILE AND ARGN)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# swivel_precompiled_as(TARGET OTHER): uses the headers that were compiled for the target OTHER,
# whose compile options must be the same; TARGET may have macros that OTHER lacks, not the reverse.
function(swivel_precompiled_as target other)
  if(SWIVEL_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${other})
  endif()
endfunction()

# swivel_compile_rooms_at_once(TARGET SOURCE...): compiles those of these sources of the target that
# lie in the same folder as one source, so that their templates are instantiated once. Folders of
# kernels, which include the same text several times, are compiled source by source.
function(swivel_compile_rooms_at_once target)
  if(NOT SWIVEL_ROOMS_AT_ONCE)
    return()
  endif()
  foreach(source IN LISTS ARGN)
    get_filename_component(folder ${source} DIRECTORY)
    if(NOT folder MATCHES "kernels$")
      string(MAKE_C_IDENTIFIER "${target}_${folder}" room)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${room})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# swivel_component(NAME SOURCES a.cpp ... PUBLIC dep ... PRIVATE dep ... PRECOMPILE <header> ...
# PRECOMPILED_AS other PKG_CONFIG -lflag ...): one library, one include root, one layer, installed
# with those of its headers that SWIVEL_PUBLIC_HEADERS names. PRECOMPILE: headers to compile once;
# PRECOMPILED_AS: those of another component instead. PKG_CONFIG: what a program must link where the
# library is static. Without SOURCES it is headers alone, under HEADERS.
function(swivel_component name)
  cmake_parse_arguments(
    arg "" "HEADERS;PRECOMPILED_AS" "SOURCES;PUBLIC;PRIVATE;PRECOMPILE;PKG_CONFIG" ${ARGN})
  set(library swivel_${name})
  if(NOT arg_HEADERS)
    set(arg_HEADERS include)
  endif()
  if(arg_SOURCES)
    set(scope PUBLIC)
    add_library(${library} ${arg_SOURCES})
    swivel_precompile(${library} ${arg_PRECOMPILE})
    if(arg_PRECOMPILED_AS)
      swivel_precompiled_as(${library} swivel_${arg_PRECOMPILED_AS})
    endif()
    swivel_compile_rooms_at_once(${library} ${arg_SOURCES})
    # Headers of its own: "room/name.hpp".
    target_include_directories(${library} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
    target_link_libraries(${library} PRIVATE $<BUILD_INTERFACE:swivel_settings> ${arg_PRIVATE})
    # Position-independent, so that plugins and modules of other languages may hold static
    # libraries. What a library calls of its own is its own, never a namesake of the program's,
    # which other compiler options may have given other bits.
    target_compile_options(${library} PRIVATE -fno-semantic-interposition)
    target_link_options(${library}
      PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/exported.map)
    set_target_properties(${library} PROPERTIES POSITION_INDEPENDENT_CODE ON
      VISIBILITY_INLINES_HIDDEN ON DEFINE_SYMBOL ""
      LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/exported.map VERSION ${PROJECT_VERSION}
      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} INSTALL_RPATH "$ORIGIN")
    set_property(GLOBAL APPEND PROPERTY SWIVEL_COMPONENTS ${name})
    set_property(GLOBAL APPEND PROPERTY SWIVEL_PKG_CONFIG ${arg_PKG_CONFIG})
  else()
    set(scope INTERFACE)
    add_library(${library} INTERFACE)
  endif()
  add_library(swivel::${name} ALIAS ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${library} ${scope} cxx_std_20)
  target_include_directories(${library} ${scope}
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/${arg_HEADERS}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${library} ${scope} ${arg_PUBLIC})
  install(TARGETS ${library} EXPORT swivelTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev)
  foreach(header IN LISTS SWIVEL_PUBLIC_HEADERS)
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${arg_HEADERS}/${header})
      get_filename_component(folder ${header} DIRECTORY)
      install(FILES ${arg_HEADERS}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder}
        COMPONENT dev)
    endif()
  endforeach()
endfunction()

# Once, after the components: targets, config and version file, so that find_package(swivel) works,
# and swivel.pc for pkg-config.
function(swivel_install_package)
  set(folder ${CMAKE_INSTALL_LIBDIR}/cmake/swivel)
  get_property(SWIVEL_COMPONENTS GLOBAL PROPERTY SWIVEL_COMPONENTS)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/swivelConfig.cmake.in
    ${PROJECT_BINARY_DIR}/swivelConfig.cmake INSTALL_DESTINATION ${folder})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/swivelConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
  install(EXPORT swivelTargets NAMESPACE swivel:: DESTINATION ${folder} COMPONENT dev)
  if(NOT SWIVEL_DEB)  # which has it under Debian's name
    install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}
      COMPONENT runtime)
  endif()
  install(FILES ${PROJECT_BINARY_DIR}/swivelConfig.cmake
    ${PROJECT_BINARY_DIR}/swivelConfigVersion.cmake DESTINATION ${folder} COMPONENT dev)

  # What `cmake --install` needs, and no more.
  add_custom_target(installed DEPENDS swivel)
  list(TRANSFORM SWIVEL_COMPONENTS PREPEND swivel_ OUTPUT_VARIABLE targets)
  add_dependencies(installed ${targets})

  # Linkers look for symbols of static libraries in those that follow, so that the lowest component
  # comes last.
  list(REVERSE SWIVEL_COMPONENTS)
  list(TRANSFORM SWIVEL_COMPONENTS PREPEND "-lswivel_" OUTPUT_VARIABLE libraries)
  if(NOT BUILD_SHARED_LIBS)
    get_property(others GLOBAL PROPERTY SWIVEL_PKG_CONFIG)
    list(APPEND libraries ${others})
  endif()
  list(JOIN libraries " " SWIVEL_LIBRARIES)
  file(RELATIVE_PATH SWIVEL_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/swivel.pc.in ${PROJECT_BINARY_DIR}/swivel.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/swivel.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
    COMPONENT dev)
endfunction()

# swivel_isa_kernels(NAME PREFIX): adds PREFIX_avx2.cpp and PREFIX_avx512.cpp, each with its own
# instruction set. Chosen at run time.
function(swivel_isa_kernels name prefix)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_sources(swivel_${name} PRIVATE ${prefix}_avx2.cpp ${prefix}_avx512.cpp)
    # Headers that were compiled for another instruction set do not serve here.
    set_source_files_properties(${prefix}_avx2.cpp ${prefix}_avx512.cpp
      PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    set_source_files_properties(${prefix}_avx2.cpp PROPERTIES COMPILE_OPTIONS "-O3;-mavx2")
    set_source_files_properties(${prefix}_avx512.cpp
      PROPERTIES COMPILE_OPTIONS "-O3;-mavx512f;-mavx512dq;-mavx512vl;-mprefer-vector-width=512")
    target_compile_definitions(swivel_${name} PRIVATE SWIVEL_X86_KERNELS)
  endif()
endfunction()
