# libpliant_core, which holds all floors, and what it loads while a program runs.

# Where tests and what else is not installed finds what it loads.
set(CMAKE_BUILD_RPATH ${PLIANT_LIBRARY_DIR})

# Lets `target` find Pliant's libraries in folders relative to its own, where it is built and
# wherever it is installed. Of two run paths, one for each, CMake would end the first with an empty folder to
# make it another than the second; that means the working directory.
function(pliant_set_run_path target)
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "${ARGN}" BUILD_WITH_INSTALL_RPATH ON)
endfunction()

# A library that others of Pliant load, or are linked to: all are in one folder, wherever that is
# moved to.
function(pliant_set_library target)
  set_target_properties(${target} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${PLIANT_LIBRARY_DIR}
    DEFINE_SYMBOL "")
  pliant_set_run_path(${target} $ORIGIN)
endfunction()

file(GLOB api_sources CONFIGURE_DEPENDS src/pliant/api/*.cpp)
add_library(pliant_core SHARED ${api_sources})
pliant_set_library(pliant_core)
target_include_directories(pliant_core PRIVATE include PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
  $<INSTALL_INTERFACE:include>)
target_link_libraries(pliant_core PUBLIC Eigen3::Eigen TBB::tbb Threads::Threads fmt::fmt yaml-cpp)
# Calls within the library go straight to what they call, as in one program.
target_link_options(pliant_core PRIVATE -Wl,-Bsymbolic-functions)
# The same for scripts/mutate, which lets a program load other forms of some functions before it.
add_library(pliant_core_to_interpose SHARED EXCLUDE_FROM_ALL $<TARGET_OBJECTS:pliant_core>)
set_target_properties(pliant_core_to_interpose PROPERTIES OUTPUT_NAME pliant_core
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/mutants/lib)
foreach(library pliant_core pliant_core_to_interpose)
  target_link_libraries(${library} PRIVATE pliant_floor_device ${CMAKE_DL_LIBS})
  foreach(floor ${PLIANT_FLOORS})
    target_link_libraries(${library} PRIVATE pliant_floor_${floor})
  endforeach()
endforeach()
target_link_libraries(pliant_core_to_interpose PRIVATE TBB::tbb Threads::Threads fmt::fmt yaml-cpp)
pliant_check_includes(pliant_core src/pliant/api ${PLIANT_FLOORS})
if(PLIANT_PRECOMPILED_HEADERS)
  target_precompile_headers(pliant_core REUSE_FROM pliant_floor_math)
endif()

# What other programs link: the library with the headers that are meant for them.
add_library(pliant_api INTERFACE)
add_library(pliant::core ALIAS pliant_api)
target_include_directories(pliant_api INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
target_compile_features(pliant_api INTERFACE cxx_std_17)
target_link_libraries(pliant_api INTERFACE pliant_core)
# Who uses only these depends on none of the floors.
pliant_check_includes(pliant_core include/pliant math)

# What takes longer to load than most programs to run is loaded when it is needed: OpenVDB when a mesh
# is sampled, ROS's libraries when a robot is read or a package is looked for.
add_library(pliant_voxels MODULE src/pliant/voxels/openvdb_signs.cpp)
target_link_libraries(pliant_voxels PRIVATE OpenVDB::openvdb)
pliant_check_includes(pliant_voxels src/pliant/voxels math geometry)
add_library(pliant_robots MODULE src/pliant/robots/robot_tree.cpp)
target_include_directories(pliant_robots SYSTEM PRIVATE ${KDL_PARSER_INCLUDE_DIR})
target_link_libraries(pliant_robots PRIVATE PkgConfig::URDFDOM PkgConfig::KDL ${KDL_PARSER_LIBRARY})
if(ROSPACK_INCLUDE_DIR AND ROSPACK_LIBRARY)
  target_sources(pliant_robots PRIVATE src/pliant/robots/ros_packages.cpp)
  target_include_directories(pliant_robots SYSTEM PRIVATE ${ROSPACK_INCLUDE_DIR})
  target_link_libraries(pliant_robots PRIVATE ${ROSPACK_LIBRARY})
endif()
pliant_check_includes(pliant_robots src/pliant/robots math scene)
set(PLIANT_LOADED pliant_voxels pliant_robots)
foreach(library ${PLIANT_LOADED})
  pliant_set_library(${library})
  target_include_directories(${library} PRIVATE src)
  target_link_libraries(${library} PRIVATE Eigen3::Eigen TBB::tbb)
endforeach()
add_dependencies(pliant_core ${PLIANT_LOADED})
