# One executable a folder of tests; ctest shows every suite by its name.

# Lets ctest run the gtests of `target`: cmake/list_suites.cmake says how.
function(pliant_add_suites target prefix)
  set(suites ${PROJECT_BINARY_DIR}/${target}_suites.cmake)
  set(costs ${PROJECT_SOURCE_DIR}/tests/slow_suites.txt)
  set(lister ${PROJECT_SOURCE_DIR}/cmake/list_suites.cmake)
  set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${costs} ${lister})
  add_custom_command(TARGET ${target} POST_BUILD BYPRODUCTS ${suites}
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${target}> -DPREFIX=${prefix} -DCOSTS=${costs}
      -DOUTPUT=${suites} -DTIMEOUT=$<IF:$<CONFIG:Release>,300,3000> -P ${lister} VERBATIM)
  set(included ${PROJECT_BINARY_DIR}/${target}_include.cmake)
  file(WRITE ${included} "if(EXISTS \"${suites}\")\n  include(\"${suites}\")\nelse()\n"
    "  add_test(${target}_not_built ${target}_not_built)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${included})
endfunction()

# What several tests use, compiled once.
file(GLOB_RECURSE support_sources CONFIGURE_DEPENDS tests/support/*.cpp)
add_library(test_support STATIC ${support_sources})
set_target_properties(test_support PROPERTIES ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
target_include_directories(test_support PUBLIC tests)
target_link_libraries(test_support PUBLIC pliant_core GTest::gtest)
if(PLIANT_PRECOMPILED_HEADERS)
  target_precompile_headers(test_support PRIVATE <Eigen/Core> <Eigen/Geometry> <fmt/format.h>
    <gtest/gtest.h> <algorithm> <cmath> <map> <memory> <string> <vector>)
endif()

# Part of each test program. Where nothing is optimised, a test has as much processor time as it likes.
add_library(test_program OBJECT tests/temporary_cache.cpp tests/cpu_budget.cpp)
target_compile_definitions(test_program PRIVATE PLIANT_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
  PLIANT_TEST_CPU_SECONDS=$<IF:$<CONFIG:Release>,30,1e9>)
target_link_libraries(test_program PRIVATE GTest::gtest)

foreach(group unit physics stability resources fuzz api generated)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS tests/${group}/*.cpp)
  if(sources)
    add_executable(${group}_tests ${sources} $<TARGET_OBJECTS:test_program>)
    # Not among the nodes, where catkin would put them.
    set_target_properties(${group}_tests PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
    target_compile_definitions(${group}_tests PRIVATE PLIANT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    target_compile_definitions(${group}_tests PRIVATE PLIANT_PROGRAM="$<TARGET_FILE:pliant_app>")
    target_link_libraries(${group}_tests PRIVATE test_support GTest::gtest_main)
    # What takes time is the library; the tests themselves are compiled to be built quickly.
    target_compile_options(${group}_tests PRIVATE $<$<CONFIG:Release>:-O1>)
    # Templates of Eigen and gtest take most of that: the more files share them, the better.
    set_target_properties(${group}_tests PROPERTIES UNITY_BUILD_BATCH_SIZE 26)
    if(PLIANT_PRECOMPILED_HEADERS)
      # Also what most of them include of ours: a change there means most of them anyway.
      if(TARGET unit_tests AND NOT group STREQUAL unit)
        target_precompile_headers(${group}_tests REUSE_FROM unit_tests)
      else()
        target_precompile_headers(${group}_tests PRIVATE <Eigen/Core> <Eigen/Geometry> <Eigen/LU>
          <fmt/format.h> <gtest/gtest.h> <algorithm> <cmath> <map> <memory> <string> <vector>
          ${PROJECT_SOURCE_DIR}/src/pliant/core/world.h)
      endif()
    endif()
    pliant_add_suites(${group}_tests ${group})
  endif()
endforeach()

# What they mend in a mutated file of the cache is a hash.
target_include_directories(fuzz_tests SYSTEM PRIVATE ${XXHASH_INCLUDE_DIR})

# As other programs do.
target_link_libraries(api_tests PRIVATE pliant::core)

# Tests of the command line run the program itself.
add_dependencies(unit_tests pliant_app)
add_dependencies(generated_tests pliant_app)

# The documentation of what the registry holds is the registry's own.
add_test(NAME docs.reference_is_up_to_date
  COMMAND ${PROJECT_SOURCE_DIR}/scripts/reference --check $<TARGET_FILE:pliant_app>)

# The build itself, and what it installs, as another project finds it.
foreach(name api_pages catkin_workspace hardening house include_rules installed_library library_page mutations one_writer
    presets replication run_paths soak test_budget test_numbers tidy)
  add_test(NAME build.${name} COMMAND ${PROJECT_SOURCE_DIR}/tests/build/${name}
    ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR} ${PLIANT_LIBRARY_DIR})
  set_tests_properties(build.${name} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 300)
endforeach()
