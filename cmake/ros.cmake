# Messages, nodes and rostests. Included where catkin is found.
set(PLIANT_ROS_PACKAGES
  diagnostic_msgs diagnostic_updater geometry_msgs interactive_markers rosconsole roscpp
  rosgraph_msgs roslib sensor_msgs std_msgs std_srvs tf2 tf2_eigen tf2_msgs tf2_ros
  visualization_msgs)
find_package(catkin REQUIRED COMPONENTS message_generation ${PLIANT_ROS_PACKAGES})

# catkin caches what setup.sh changes in the environment, for its tests. That is nothing where it
# was sourced already, so that the tests would fail in every other shell.
set(environment_was_sourced FALSE)
foreach(variable CMAKE_PREFIX_PATH LD_LIBRARY_PATH PATH PKG_CONFIG_PATH PYTHONPATH ROS_PACKAGE_PATH)
  string(REPLACE ":" ";" entries "$ENV{${variable}}")
  set(others ${entries})
  list(FILTER others EXCLUDE REGEX "^${CATKIN_DEVEL_PREFIX}(/|$)")
  list(REMOVE_ITEM others ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/)
  if(NOT "${others}" STREQUAL "${entries}")
    set(environment_was_sourced TRUE)
    string(REPLACE ";" ":" others "${others}")
    set(ENV{${variable}} "${others}")
  endif()
endforeach()
if(environment_was_sourced)
  unset(ENV{ROS_MASTER_URI})
  safe_execute_process(COMMAND ${GENERATE_ENVIRONMENT_CACHE_COMMAND})
endif()

file(GLOB message_files RELATIVE ${PROJECT_SOURCE_DIR}/msg CONFIGURE_DEPENDS msg/*.msg)
file(GLOB service_files RELATIVE ${PROJECT_SOURCE_DIR}/srv CONFIGURE_DEPENDS srv/*.srv)
add_message_files(FILES ${message_files})
add_service_files(FILES ${service_files})
generate_messages(DEPENDENCIES geometry_msgs std_msgs)

catkin_package(
  INCLUDE_DIRS include src
  CATKIN_DEPENDS message_runtime ${PLIANT_ROS_PACKAGES}
  CFG_EXTRAS pliant-extras.cmake)

set(PLIANT_NODES pliant_node cloth_node patch_node reduced_node viscoelastic_node robot_player
  rviz_of_scene)
file(GLOB_RECURSE ros_sources CONFIGURE_DEPENDS src/pliant/ros/*.cpp)
foreach(node ${PLIANT_NODES})
  list(REMOVE_ITEM ros_sources ${PROJECT_SOURCE_DIR}/src/pliant/ros/${node}.cpp)
endforeach()
add_library(pliant_ros SHARED ${ros_sources})
add_library(pliant::ros ALIAS pliant_ros)
pliant_set_library(pliant_ros)
pliant_check_includes(pliant_ros src/pliant/ros ${PLIANT_FLOORS})
set(messages ${CATKIN_DEVEL_PREFIX}/${CATKIN_GLOBAL_INCLUDE_DESTINATION})
list(REMOVE_ITEM catkin_INCLUDE_DIRS ${messages})
target_include_directories(pliant_ros SYSTEM PUBLIC $<BUILD_INTERFACE:${messages}>
  ${catkin_INCLUDE_DIRS})
target_link_libraries(pliant_ros PUBLIC pliant_core ${catkin_LIBRARIES})
add_dependencies(pliant_ros ${PROJECT_NAME}_generate_messages_cpp)

foreach(node ${PLIANT_NODES})
  add_executable(${node} src/pliant/ros/${node}.cpp)
  set_target_properties(${node} PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
  pliant_set_run_path(${node} $ORIGIN/..)
  target_link_libraries(${node} PRIVATE pliant_ros)
endforeach()
catkin_install_python(PROGRAMS scripts/demo_summary
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})

# What a demo needs, without the tests.
add_custom_target(demo_nodes DEPENDS ${PLIANT_NODES} ${PROJECT_NAME}_generate_messages)

install(TARGETS ${PLIANT_NODES} RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})

if(PLIANT_TESTS)
  find_package(rostest REQUIRED)
  # catkin_add_gtest keeps catkin's test targets and the results' folder as rostest expects them.
  file(GLOB ros_test_sources CONFIGURE_DEPENDS tests/ros/unit/*_test.cpp)
  if(ros_test_sources)
    catkin_add_gtest(ros_unit_tests ${ros_test_sources})
    target_compile_definitions(ros_unit_tests PRIVATE PLIANT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    target_link_libraries(ros_unit_tests pliant_ros GTest::gtest_main)
  endif()
  file(GLOB rostests RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS tests/ros/*.test)
  foreach(rostest ${rostests})
    add_rostest(${rostest} DEPENDENCIES demo_nodes)
    string(REPLACE "/" "_" test_name ${rostest})
    # One after the other, from the start, beside tests without nodes: they mostly wait.
    set_tests_properties(_ctest_${PROJECT_NAME}_rostest_${test_name} PROPERTIES
      TIMEOUT 150 COST 1000 RESOURCE_LOCK nodes)
  endforeach()
  # Alone: these hold the times of steps against the clock.
  foreach(test_name overhead running_node)
    set_tests_properties(_ctest_${PROJECT_NAME}_rostest_tests_ros_${test_name}.test PROPERTIES
      RUN_SERIAL TRUE)
  endforeach()
  option(PLIANT_DISPLAY_TESTS "Test launch files with rviz on a virtual display" ON)
  if(PLIANT_DISPLAY_TESTS)
    add_test(NAME launch_files
      COMMAND ${CATKIN_ENV} /usr/bin/python3 ${PROJECT_SOURCE_DIR}/tests/ros/launch/launch_files_test.py)
    set_tests_properties(launch_files PROPERTIES TIMEOUT 280 RUN_SERIAL TRUE)
  endif()
  # catkin's test targets are not part of `all`.
  add_custom_target(build_tests ALL)
  add_dependencies(build_tests tests demo_nodes)
endif()
