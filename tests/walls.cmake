# The walls of the house: an include points at its own entry of this list or at one above
# it. The longest entry that a path begins with counts.
#
#   cmake -D ROOT=FOLDER -P walls.cmake
set(order
  raster/numbers raster/lanes raster/threads raster/images raster/pipeline raster/passes raster/shaders raster/shaders/glsl raster/temporal raster/effects/motion raster/effects raster/raster.h
  dof/fixed dof dof/two_pass dof/one_pass dof/disc_layers dof/scatter
  dof/half_resolution dof/ring_bucket dof/circular dof/polygon dof/mipmap dof/object_layers dof/ray_distribution
  dof/methods dof/fixed_pictures dof/pipelines dof/method.cpp dof/measure dof/auto dof/c
  scenes/scene.h scenes/parameters.h scenes/make scenes/random scenes/files scenes/surfaces scenes/models scenes/load scenes/embree scenes/lens_views/lens_points.h scenes/lens_views/lens_points.cpp scenes/shadows scenes/shadows/maps scenes/shadows/volumes
  scenes/draw scenes/relief scenes/relief/warp scenes/relief/impostors scenes/lens_views scenes/traced_relief
  scenes/temporal scenes/filtered_views scenes/warped_views
  scenes/surface_splatting scenes/lens_views/lens_view_method.cpp scenes/auto scenes/frame scenes/scenes.h
  tools/cli tools/files tools/pictures tools/gl/driver/functions.h tools/gl/driver/api.h tools/gl/driver/driver.h tools/gl/emulated tools/gl/driver tools/gl tools/options tools/info tools/sequence tools/render tools/relief tools/refocus/depth tools/refocus tools/plugins tools/effects tools/compare tools/bench
  tools/golden tools/report tools/chart tools/chart/contenders tools/chart/report tools/chart/subject.cpp tools/chart/command.cpp tools/stress/cases tools/stress tools/goldens
  tools/crosscheck tools/boards tools/page tools/program.h tools/program.cpp tools/npm tools)

# place_of(PATH VARIABLE): the number of its entry, or -1. A path is looked up once.
function(place_of path variable)
  get_property(known GLOBAL PROPERTY "place of ${path}")
  if(DEFINED known)
    set(${variable} ${known} PARENT_SCOPE)
    return()
  endif()
  set(best -1)
  set(best_length 0)
  set(place 0)
  foreach(entry IN LISTS order)
    string(LENGTH ${entry} length)
    string(FIND "${path}/" "${entry}/" found)
    if(found EQUAL 0 AND length GREATER best_length)
      set(best ${place})
      set(best_length ${length})
    endif()
    math(EXPR place "${place} + 1")
  endforeach()
  set_property(GLOBAL PROPERTY "place of ${path}" ${best})
  set(${variable} ${best} PARENT_SCOPE)
endfunction()

set(wrong 0)
foreach(room raster dof scenes tools)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${room}/*.h ${ROOT}/${room}/*.cpp
       ${ROOT}/${room}/*.inl)
  if(NOT files)
    message(FATAL_ERROR "${ROOT}/${room} has no files")
  endif()
  foreach(file IN LISTS files)
    place_of(${file} from)
    file(STRINGS ${ROOT}/${file} includes REGEX "^ *#include \"")
    foreach(line IN LISTS includes)
      string(REGEX REPLACE "^ *#include \"([^\"]*)\".*" "\\1" path "${line}")
      place_of("${path}" to)
      if(to EQUAL -1 OR from EQUAL -1 OR to GREATER from)
        message("${file} includes ${path}, which is not below it")
        math(EXPR wrong "${wrong} + 1")
      endif()
    endforeach()
  endforeach()
endforeach()
if(wrong)
  message(FATAL_ERROR "${wrong} includes point up; docs/code-guide.md has the order of the rooms")
endif()
