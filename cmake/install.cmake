# What `cmake --install` and catkin install, and what other projects find: one list, with ROS and
# without.
include(CMakePackageConfigHelpers)

set(share share/${PROJECT_NAME})
set(package_files ${share}/cmake)  # where catkin puts its own
set_target_properties(pliant_api PROPERTIES EXPORT_NAME core)
set_target_properties(pliant_core PROPERTIES EXPORT_NAME library)
set(libraries pliant_api pliant_core)
foreach(name cuda ros)
  if(TARGET pliant_${name})
    set_target_properties(pliant_${name} PROPERTIES EXPORT_NAME ${name})
    list(APPEND libraries pliant_${name})
  endif()
endforeach()

# The component `runtime` is what a wheel of the Python package takes in.
install(TARGETS ${libraries} EXPORT pliantTargets LIBRARY DESTINATION lib COMPONENT runtime)
install(TARGETS ${PLIANT_LOADED} LIBRARY DESTINATION lib COMPONENT runtime)
install(TARGETS pliant_app RUNTIME DESTINATION bin COMPONENT runtime)
install(DIRECTORY include/pliant src/pliant DESTINATION include FILES_MATCHING PATTERN "*.h"
  PATTERN app EXCLUDE)
install(DIRECTORY launch examples DESTINATION ${share})
install(DIRECTORY config DESTINATION ${share} COMPONENT runtime)
install(PROGRAMS scripts/plot_accuracy scripts/plot_cloth scripts/plot_judges scripts/plot_reduced
  scripts/plot_viscoelastic scripts/plot_identify scripts/identify scripts/sweep
  DESTINATION ${share}/scripts COMPONENT runtime)
install(FILES scripts/whole_file.py scripts/sweep_run.py scripts/sweep_engines.py
  scripts/sweep_shard.py scripts/sweep_merge.py scripts/identify_data.py scripts/identify_fit.py
  DESTINATION ${share}/scripts COMPONENT runtime)

# Other projects find installed Pliant, or its build folder or catkin's devel space, by the same
# files: pliantTargets.cmake is CMake's, pliant-extras.cmake includes it and finds what it needs.
# The file that includes that is catkin's pliantConfig.cmake or, without ROS, ours.
install(EXPORT pliantTargets NAMESPACE pliant:: DESTINATION ${package_files}
  COMPONENT package_files)
set(found_in_build ${PROJECT_BINARY_DIR})
if(TARGET pliant_ros)
  set(found_in_build ${CATKIN_DEVEL_PREFIX}/${package_files})
else()
  configure_package_config_file(cmake/pliantConfig.cmake.in ${PROJECT_BINARY_DIR}/pliantConfig.cmake
    INSTALL_DESTINATION ${package_files} NO_SET_AND_CHECK_MACRO)
  configure_file(cmake/pliant-extras.cmake.in ${PROJECT_BINARY_DIR}/pliant-extras.cmake @ONLY)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/pliantConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/pliantConfig.cmake
    ${PROJECT_BINARY_DIR}/pliantConfigVersion.cmake ${PROJECT_BINARY_DIR}/pliant-extras.cmake
    DESTINATION ${package_files} COMPONENT package_files)
  install(FILES package.xml DESTINATION ${share})  # for paths that begin with package://pliant
endif()
export(EXPORT pliantTargets NAMESPACE pliant:: FILE ${found_in_build}/pliantTargets.cmake)
