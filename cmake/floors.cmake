# The floors of the house, from the ground up: each a target of objects, which together are the
# library. A floor may include those below it; a build in which one includes another fails.
set(PLIANT_FLOORS math laws geometry core elements solvers effects models scene study)

# Lets the build of `target` fail, before anything of it is compiled, where a file in `folder`
# includes a folder of Pliant that is neither its own nor named in ARGN.
function(pliant_check_includes target folder)
  get_filename_component(own ${folder} NAME)
  string(MAKE_C_IDENTIFIER includes_of_${folder} check)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS
    ${folder}/*.h ${folder}/*.cpp ${folder}/*.cu ${folder}/*.cuh)
  set(stamp ${CMAKE_CURRENT_BINARY_DIR}/generated/${check}.stamp)
  set(allowed ${ARGN} ${own})
  string(REPLACE ";" "," allowed "${allowed}")
  add_custom_command(OUTPUT ${stamp}
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${PROJECT_SOURCE_DIR}/${folder} -DALLOWED=${allowed}
      -DSTAMP=${stamp} -P ${PROJECT_SOURCE_DIR}/cmake/check_includes.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/check_includes.cmake
    COMMENT "Looking at what ${folder} includes" VERBATIM)
  add_custom_target(${check} DEPENDS ${stamp})
  add_dependencies(${target} ${check})
endfunction()

# Adds the floor `name`, in `folder`, above the floors that ARGN names.
function(pliant_add_floor name folder)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  # Loops of their own: these files share little.
  set(alone ${sources})
  list(FILTER alone INCLUDE REGEX
    "/(elements|solvers|effects|mesh_checks|repair|models/viscoelastic|cuda)/|/polynomial_kernel.cpp")
  set_source_files_properties(${alone} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  if(NOT sources)
    # Headers alone: a target of their own looks at what they include.
    add_library(pliant_floor_${name} INTERFACE)
    pliant_check_includes(pliant_floor_${name} ${folder} ${ARGN})
    return()
  endif()
  add_library(pliant_floor_${name} OBJECT ${sources})
  # Whoever includes a header of it needs these.
  target_include_directories(pliant_floor_${name} PRIVATE src .)
  target_link_libraries(pliant_floor_${name} PRIVATE Eigen3::Eigen TBB::tbb fmt::fmt yaml-cpp)
  pliant_check_includes(pliant_floor_${name} ${folder} ${ARGN})
  if(NOT PLIANT_PRECOMPILED_HEADERS)
    return()
  endif()
  if(TARGET pliant_floor_math AND NOT name STREQUAL math)
    target_precompile_headers(pliant_floor_${name} REUSE_FROM pliant_floor_math)
  else()
    target_precompile_headers(pliant_floor_${name} PRIVATE <Eigen/Core> <Eigen/Geometry> <Eigen/LU>
      <fmt/format.h> <tbb/blocked_range.h> <tbb/parallel_for.h> <tbb/partitioner.h>
      <algorithm> <cmath> <limits> <map> <memory> <string> <vector>)
  endif()
endfunction()

set(below)
foreach(floor ${PLIANT_FLOORS})
  pliant_add_floor(${floor} src/pliant/${floor} ${below})
  list(APPEND below ${floor})
endforeach()
# What the CUDA backend does on the CPU: packing, and all algorithms without a GPU, for tests.
pliant_add_floor(device cuda math laws geometry core elements solvers effects models)

# What single floors take from other libraries.
target_link_libraries(pliant_floor_geometry PRIVATE
  assimp::assimp ${OPENMESH_TOOLS} ${OPENMESH_CORE} ${QHULL_LIBRARY})
target_include_directories(pliant_floor_geometry SYSTEM PRIVATE
  ${QHULL_INCLUDE_DIR} ${XXHASH_INCLUDE_DIR})
target_link_libraries(pliant_floor_scene PRIVATE
  PkgConfig::URDFDOM PkgConfig::TINYXML2 PkgConfig::KDL)
if(ROSPACK_INCLUDE_DIR AND ROSPACK_LIBRARY)
  target_compile_definitions(pliant_floor_scene PRIVATE PLIANT_ROSPACK)
endif()
if(SPECTRA_INCLUDE_DIR)
  target_include_directories(pliant_floor_models SYSTEM PRIVATE ${SPECTRA_INCLUDE_DIR})
  target_compile_definitions(pliant_floor_models PRIVATE PLIANT_SPECTRA)
endif()
# The program holds the table of fabrics: no path to a file can be wrong.
file(READ config/fabrics.yaml PLIANT_FABRICS)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS config/fabrics.yaml)
configure_file(cmake/fabrics_text.cpp.in generated/fabrics_text.cpp @ONLY)
target_sources(pliant_floor_scene PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated/fabrics_text.cpp)
