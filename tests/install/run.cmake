# Installs BUILD under SCRATCH, looks at what was installed, and builds strangers' projects against
# it.
cmake_minimum_required(VERSION 3.25)  # for IN_LIST
function(run output)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE printed
    ERROR_VARIABLE complaints)
  if(NOT code EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nended with ${code}:\n${printed}${complaints}")
  endif()
  set(${output} "${printed}" PARENT_SCOPE)
endfunction()

set(prefix ${SCRATCH}/prefix)
set(consumer ${SOURCE}/tests/install/consumer)
set(main ${consumer}/main.cpp)
file(REMOVE_RECURSE ${SCRATCH})
run(_ ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})

# Targets of other packages: each must be asked for by name, since what one package finds for
# another differs between systems.
file(GLOB_RECURSE targets ${prefix}/*/swivelTargets.cmake)
file(GLOB_RECURSE config ${prefix}/*/swivelConfig.cmake)
file(READ ${targets} text)
file(READ ${config} asked)
string(REGEX MATCHALL "[A-Za-z0-9_-]+::" packages "${text}")
list(TRANSFORM packages REPLACE "::" "")
list(REMOVE_DUPLICATES packages)
list(REMOVE_ITEM packages swivel)
list(LENGTH packages count)
if(count LESS 2 OR (NOT SHARED AND count LESS 4))
  message(FATAL_ERROR "found but ${count} packages in ${targets}: ${packages}")
endif()
foreach(package IN LISTS packages)
  if(NOT asked MATCHES "find_dependency\\(${package}[ )]")
    message(SEND_ERROR
      "swivelTargets.cmake names ${package}::..., which swivelConfig.cmake does not find")
  endif()
endforeach()

file(GLOB_RECURSE notices RELATIVE ${prefix} ${prefix}/share/doc/*)
if(NOT notices MATCHES "LICENSE" OR (PAGES AND NOT notices MATCHES "THIRD-PARTY.txt"))
  message(SEND_ERROR "licences are missing among what is installed: ${notices}")
endif()

# The headers that the project names, no other, are installed, and include no other of the project.
include(${SOURCE}/cmake/public_headers.cmake)
file(GLOB_RECURSE headers RELATIVE ${prefix}/include ${prefix}/include/*)
set(named ${SWIVEL_PUBLIC_HEADERS})
list(SORT headers)
list(SORT named)
list(LENGTH named count)
if(NOT headers STREQUAL named OR count LESS 20 OR count GREATER 90)
  message(SEND_ERROR
    "installed are the headers ${headers}, named are the ${count} (20 to 90 are allowed) ${named}")
endif()
foreach(header IN LISTS headers)
  file(STRINGS ${prefix}/include/${header} includes REGEX "^#include \"")
  foreach(line IN LISTS includes)
    string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" included "${line}")
    if(NOT included IN_LIST named)
      message(SEND_ERROR "${header} includes ${included}, which is not installed")
    endif()
  endforeach()
endforeach()

# Every header compiles alone, and reads nothing but headers of Swivel, Eigen and the standard
# library. The headers are the same where libraries are static, so this minute is spent once.
if(SHARED)
  run(_ ${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/tests/install/headers -B ${SCRATCH}/headers
    -DCMAKE_CXX_COMPILER=${CXX} -DSWIVEL_PREFIX=${prefix} -DEIGEN=${EIGEN})
  run(_ ${CMAKE_COMMAND} --build ${SCRATCH}/headers)
  run(read ninja -C ${SCRATCH}/headers -t deps)
  run(allowed ninja -C ${SCRATCH}/headers -t deps CMakeFiles/headers.dir/allowed.cpp.o)
  foreach(list IN ITEMS read allowed)
    string(REGEX MATCHALL "\n    [^\n]+" ${list} "${${list}}")
    list(REMOVE_DUPLICATES ${list})
  endforeach()
  list(REMOVE_ITEM read ${allowed})
  list(LENGTH read count)
  list(FILTER read EXCLUDE REGEX "${prefix}/include/swivel/|alone/")
  if(read OR count LESS 60)
    message(SEND_ERROR
      "installed headers read ${count} files, among them headers of others: ${read}")
  endif()
endif()

if(PYTHON)  # the module finds shared libraries from where it lies
  file(GLOB_RECURSE package ${prefix}/*/__init__.py)
  get_filename_component(folder ${package} DIRECTORY)
  get_filename_component(folder ${folder} DIRECTORY)
  run(printed ${CMAKE_COMMAND} -E env PYTHONPATH=${folder} PYTHONDONTWRITEBYTECODE=1 ${PYTHON} -c
      "import swivel\nprint(swivel.__file__, swivel.Box([1, 2, 3]))")
  if(NOT printed STREQUAL "${package} Box([1.0, 2.0, 3.0])\n")
    message(SEND_ERROR "the Python package printed ${printed}")
  endif()
endif()

# By CMake, without Boost and with it.
foreach(boost IN ITEMS OFF ON)
  run(_ ${CMAKE_COMMAND} -G Ninja -S ${consumer} -B ${SCRATCH}/cmake_${boost}
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${CXX} -DMAIN=${main} -DBOOST=${boost}
    -DVERSION=${VERSION})
  run(_ ${CMAKE_COMMAND} --build ${SCRATCH}/cmake_${boost})
endforeach()
run(printed ${SCRATCH}/cmake_OFF/consumer)
if(NOT printed MATCHES "^yes: a path past a box\n.*yes: another thread cancels\n$"
  OR printed MATCHES "NO:")
  message(SEND_ERROR "the consumer printed ${printed}")
endif()

# By pkg-config: a program, and a plugin, which static libraries must be position-independent for.
file(GLOB_RECURSE pc ${prefix}/*/swivel.pc)
get_filename_component(folder ${pc} DIRECTORY)
set(ENV{PKG_CONFIG_PATH} ${folder})
get_filename_component(libraries ${folder} DIRECTORY)
run(flags ${PKG_CONFIG} --cflags swivel)
separate_arguments(flags UNIX_COMMAND "${flags}")
run(_ ${CXX} -std=c++20 -O0 -fPIC -c -o ${SCRATCH}/main.o ${main} ${flags})
foreach(static IN ITEMS "" "--static")
  run(flags ${PKG_CONFIG} --libs ${static} swivel)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run(_ ${CXX} -o ${SCRATCH}/program ${SCRATCH}/main.o ${flags} -Wl,-rpath,${libraries})
  run(again ${SCRATCH}/program)
  if(NOT again STREQUAL printed)
    message(SEND_ERROR "built with pkg-config ${static} the consumer printed ${again}")
  endif()
  if(SHARED)
    break()  # there are no static libraries
  endif()
endforeach()
run(_ ${CXX} -shared -Wl,-z,defs,-z,text -o ${SCRATCH}/plugin.so ${SCRATCH}/main.o ${flags})

if(SHARED)
  run(version ${prefix}/bin/swivel --version)  # finds its libraries beside itself
  file(GLOB shared ${libraries}/libswivel_*.so)
  list(LENGTH shared count)
  if(count LESS 7)
    message(FATAL_ERROR "found but ${count} shared libraries: ${shared}")
  endif()
  foreach(library IN LISTS shared)
    # Strangers' names must not get out; ours must.
    run(symbols nm --dynamic --defined-only --demangle ${library})
    string(REGEX MATCHALL "[^\n]+" symbols "${symbols}")
    list(LENGTH symbols count)
    list(FILTER symbols EXCLUDE REGEX
      " [A-Za-z] (typeinfo for |typeinfo name for |vtable for )?swivel::")
    if(symbols OR count LESS 3)
      message(SEND_ERROR "${library} exports ${count} symbols, among them ${symbols}")
    endif()
    run(dynamic readelf --dynamic ${library})
    if(NOT dynamic MATCHES "soname: \\[libswivel_[a-z]+\\.so\\.[0-9]+\\.[0-9]+\\]")
      message(SEND_ERROR "${library} has no versioned SONAME: ${dynamic}")
    endif()
  endforeach()
endif()
file(REMOVE_RECURSE ${SCRATCH})
