# Coverage-guided fuzzing by libFuzzer, which belongs to clang: scripts/fuzz runs it. The same targets
# are among the tests of every compiler, with seeded mutations.
if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  message(FATAL_ERROR "PLIANT_FUZZ needs clang (Debian: clang): use the preset `fuzz`, or scripts/fuzz")
endif()
add_executable(pliant_fuzz tests/libfuzzer/main.cpp tests/fuzz/targets.cpp)
target_include_directories(pliant_fuzz PRIVATE tests)
target_include_directories(pliant_fuzz SYSTEM PRIVATE ${XXHASH_INCLUDE_DIR})
target_compile_definitions(pliant_fuzz PRIVATE PLIANT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(pliant_fuzz PRIVATE pliant_core GTest::gtest)
target_link_options(pliant_fuzz PRIVATE -fsanitize=fuzzer)
