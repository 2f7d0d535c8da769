option(SWIVEL_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(SWIVEL_BENCH "Build the benchmarks" OFF)
option(SWIVEL_WERROR "Treat warnings as errors" OFF)
option(SWIVEL_FRAME_POINTERS "Keep frame pointers, for profilers" OFF)
set(SWIVEL_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
# A package found by one component must be seen where that component is linked.
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

if(PROJECT_IS_TOP_LEVEL AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(SWIVEL_CCACHE ccache)
  mark_as_advanced(SWIVEL_CCACHE)
  if(SWIVEL_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER "${SWIVEL_CCACHE}")
  endif()
endif()

# Compile settings of every target of the project, and of nobody else.
add_library(swivel_settings INTERFACE)
# No contraction: the same bits with and without FMA, so that every vector unit gives the same answer.
# No errno, no trapping: neither changes a value, both are needed to vectorise sqrt and selects.
# GCC 12 warns of overlaps inside std::string that are not there (-Wrestrict).
target_compile_options(swivel_settings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wno-restrict -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(SWIVEL_WERROR)
  target_compile_options(swivel_settings INTERFACE -Werror)
endif()
if(SWIVEL_FRAME_POINTERS)
  target_compile_options(swivel_settings INTERFACE -fno-omit-frame-pointer -mno-omit-leaf-frame-pointer)
endif()
if(SWIVEL_SANITIZE)
  target_compile_options(swivel_settings INTERFACE -fsanitize=${SWIVEL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(swivel_settings INTERFACE -fsanitize=${SWIVEL_SANITIZE})
endif()

# swivel_component(NAME SOURCES a.cpp ... PUBLIC dep ... PRIVATE dep ...): one library, one include root, one layer, installed.
function(swivel_component name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(swivel_${name} STATIC ${arg_SOURCES})
  add_library(swivel::${name} ALIAS swivel_${name})
  set_target_properties(swivel_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(swivel_${name} PUBLIC cxx_std_20)
  target_include_directories(swivel_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                                   $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(swivel_${name} PUBLIC ${arg_PUBLIC} PRIVATE $<BUILD_INTERFACE:swivel_settings> ${arg_PRIVATE})
  install(TARGETS swivel_${name} EXPORT swivelTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev FILES_MATCHING PATTERN "*.hpp")
  set_property(GLOBAL APPEND PROPERTY SWIVEL_COMPONENTS ${name})
endfunction()

# Once, after the components: targets, config and version file, so that find_package(swivel) works.
function(swivel_install_package)
  set(folder ${CMAKE_INSTALL_LIBDIR}/cmake/swivel)
  get_property(SWIVEL_COMPONENTS GLOBAL PROPERTY SWIVEL_COMPONENTS)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/swivelConfig.cmake.in ${PROJECT_BINARY_DIR}/swivelConfig.cmake
                                INSTALL_DESTINATION ${folder})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/swivelConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(EXPORT swivelTargets NAMESPACE swivel:: DESTINATION ${folder} COMPONENT dev)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
  install(FILES ${PROJECT_BINARY_DIR}/swivelConfig.cmake ${PROJECT_BINARY_DIR}/swivelConfigVersion.cmake DESTINATION ${folder}
          COMPONENT dev)
endfunction()

# swivel_isa_kernels(NAME PREFIX): adds PREFIX_avx2.cpp and PREFIX_avx512.cpp, each with its own instruction set. Chosen at run time.
function(swivel_isa_kernels name prefix)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_sources(swivel_${name} PRIVATE ${prefix}_avx2.cpp ${prefix}_avx512.cpp)
    set_source_files_properties(${prefix}_avx2.cpp PROPERTIES COMPILE_OPTIONS "-O3;-mavx2")
    set_source_files_properties(${prefix}_avx512.cpp PROPERTIES COMPILE_OPTIONS "-O3;-mavx512f;-mavx512dq;-mavx512vl;-mprefer-vector-width=512")
    target_compile_definitions(swivel_${name} PRIVATE SWIVEL_X86_KERNELS)
  endif()
endfunction()
