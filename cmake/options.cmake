option(SWIVEL_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(SWIVEL_BENCH "Build the benchmarks" OFF)
option(SWIVEL_WERROR "Treat warnings as errors" OFF)
set(SWIVEL_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)

# Compile settings of every target of the project, and of nobody else.
add_library(swivel_settings INTERFACE)
# No contraction: the same bits with and without FMA, so that every vector unit gives the same answer.
# No errno, no trapping: neither changes a value, both are needed to vectorise sqrt and selects.
target_compile_options(swivel_settings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(SWIVEL_WERROR)
  target_compile_options(swivel_settings INTERFACE -Werror)
endif()
if(SWIVEL_SANITIZE)
  target_compile_options(swivel_settings INTERFACE -fsanitize=${SWIVEL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(swivel_settings INTERFACE -fsanitize=${SWIVEL_SANITIZE})
endif()

# swivel_component(NAME SOURCES a.cpp ... PUBLIC dep ... PRIVATE dep ...): one library, one include root, one layer.
function(swivel_component name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(swivel_${name} STATIC ${arg_SOURCES})
  add_library(swivel::${name} ALIAS swivel_${name})
  target_compile_features(swivel_${name} PUBLIC cxx_std_20)
  target_include_directories(swivel_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
  target_link_libraries(swivel_${name} PUBLIC ${arg_PUBLIC} PRIVATE $<BUILD_INTERFACE:swivel_settings> ${arg_PRIVATE})
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
