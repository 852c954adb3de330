# The CUDA backend and its tests. Included where a CUDA compiler is found.

if(CMAKE_VERSION VERSION_LESS 3.18)
  message(STATUS "CUDA needs CMake 3.18 or newer: the CPU backend only")
  return()
endif()

# Given before the language is enabled: CMake's own choice would be a GPU too old for the compiler,
# or one that this machine does not have.
if(NOT CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES "75;90" CACHE STRING "GPU generations to build for" FORCE)
endif()
set(CMAKE_CUDA_STANDARD 17)
set(CMAKE_CUDA_STANDARD_REQUIRED ON)
enable_language(CUDA)

# No fast-math, and no contraction to fused multiply-add, as on the CPU: what both compute from one
# source has the same bits. 20012 is a remark on Eigen's defaulted functions.
set(cuda_options -fmad=false --expt-relaxed-constexpr -diag-suppress=20012
  -Xcompiler=-Wall,-Wextra,-fno-math-errno,-fno-trapping-math,-ffp-contract=off)
add_compile_options("$<$<COMPILE_LANGUAGE:CUDA>:${cuda_options}>")

if(PLIANT_TESTS)
  file(GLOB cuda_test_sources CONFIGURE_DEPENDS tests/cuda/*.cu tests/cuda/*.cpp)
  add_executable(cuda_tests ${cuda_test_sources})
  target_include_directories(cuda_tests PRIVATE src tests)
  target_link_libraries(cuda_tests PRIVATE Eigen3::Eigen GTest::gtest GTest::gtest_main)
  # Without a GPU every test says that it skips, and why.
  include(GoogleTest)
  gtest_discover_tests(cuda_tests TEST_PREFIX "cuda." DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
endif()
