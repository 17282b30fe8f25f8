# Installs the package, builds the programs of docs/examples/embedding against it and holds
# what they print against the golden hashes, which the flags they are built with must not
# change:
#   cmake -D BUILD=FOLDER -D SOURCE=FOLDER -D CXX=COMPILER -P embedding.cmake
set(work ${BUILD}/embedding)
set(triangle_hash 2e4e01e28b673d46)
set(blur_hash 0d6a42bf84e87dce)

# run(COMMAND...): its standard output as `output`; stops if it fails.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}: ended with ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# expect(PROGRAM HASH)
function(expect program hash)
  run(${program})
  if(NOT output STREQUAL hash)
    message(FATAL_ERROR "${program} prints ${output}, not ${hash}")
  endif()
  message("${program}: ${output}")
endfunction()

file(REMOVE_RECURSE ${work})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
foreach(internal dof/method.cpp dof/weights.h dof/picture_planes.h raster/lanes/lanes.inl)
  if(EXISTS ${work}/prefix/include/softfocus/${internal})
    message(FATAL_ERROR "${internal} is internal, and installed")
  endif()
endforeach()
run(${CMAKE_COMMAND} -S ${SOURCE}/docs/examples/embedding -B ${work}/build
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${work}/prefix)
run(${CMAKE_COMMAND} --build ${work}/build -j 2)
expect(${work}/build/blur_buffer ${blur_hash})
expect(${work}/build/blur_buffer_fast ${blur_hash})
expect(${work}/build/triangle ${triangle_hash})

# The same by pkg-config, and how much dof.h makes a compiler read.
find_program(PKG_CONFIG pkg-config)
if(PKG_CONFIG)
  set(ENV{PKG_CONFIG_PATH} ${work}/prefix/lib/pkgconfig)
  file(GLOB_RECURSE pc ${work}/prefix/softfocus-dof.pc)
  get_filename_component(folder "${pc}" DIRECTORY)
  set(ENV{PKG_CONFIG_PATH} ${folder})
  run(${PKG_CONFIG} --define-variable=prefix=${work}/prefix --cflags --libs softfocus-dof)
  separate_arguments(flags UNIX_COMMAND "${output}")
  run(${CXX} -O1 ${SOURCE}/docs/examples/embedding/blur_buffer.cpp -o ${work}/by_pkg_config ${flags})
  expect(${work}/by_pkg_config ${blur_hash})
else()
  message("skipped: pkg-config is not there")
endif()
file(WRITE ${work}/reads.cpp "#include <softfocus/dof.h>\n")
run(${CXX} -std=c++20 -I ${work}/prefix/include -E ${work}/reads.cpp -o ${work}/reads.ii)
file(STRINGS ${work}/reads.ii lines)
list(LENGTH lines count)
if(count GREATER 30000)
  message(FATAL_ERROR "dof.h makes a compiler read ${count} lines, more than 30000")
endif()
