# The CUDA backend and its tests. Included where a CUDA compiler is found.

# Given before the language is enabled: CMake's own choice would be a GPU too old for the compiler,
# or one that this machine does not have.
if(NOT CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES "75;90" CACHE STRING "GPU generations to build for" FORCE)
endif()
set(CMAKE_CUDA_STANDARD 17)
set(CMAKE_CUDA_STANDARD_REQUIRED ON)
enable_language(CUDA)

# No fast-math. 20012 and 20014 are remarks on functions of Eigen that no kernel calls.
set(cuda_options --expt-relaxed-constexpr -diag-suppress=20012,20014
  -Xcompiler=-Wall,-Wextra,-fno-math-errno,-fno-trapping-math,-ffp-contract=off)
add_compile_options("$<$<COMPILE_LANGUAGE:CUDA>:${cuda_options}>")

file(GLOB_RECURSE cuda_sources CONFIGURE_DEPENDS cuda/*.cu)
# What touches of a sheet is found with the CPU's bits: no contraction to fused multiply-add.
set_source_files_properties(${PROJECT_SOURCE_DIR}/cuda/effects/cuda_sheet_search.cu
  PROPERTIES COMPILE_OPTIONS -fmad=false)
# Loaded by the library when a scene asks for it: floors below name nothing of it.
add_library(pliant_cuda SHARED ${cuda_sources})
add_library(pliant::cuda ALIAS pliant_cuda)
pliant_set_library(pliant_cuda)
target_link_libraries(pliant_cuda PUBLIC pliant_core)
# Programs may bring a CUDA runtime of their own: each keeps to its own.
target_link_options(pliant_cuda PRIVATE -Wl,-Bsymbolic-functions
  -Wl,--exclude-libs,libcudart_static.a)
foreach(program pliant_app ${PLIANT_NODES})
  if(TARGET ${program})
    add_dependencies(${program} pliant_cuda)
  endif()
endforeach()

if(PLIANT_BENCH)
  foreach(name cuda_bench cuda_particles_bench)
    add_executable(${name} bench/${name}.cu)
    target_link_libraries(${name} PRIVATE pliant_cuda CLI11::CLI11)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    if(TARGET benches)
      add_dependencies(benches ${name})
    endif()
  endforeach()
endif()

if(PLIANT_TESTS)
  file(GLOB cuda_test_sources CONFIGURE_DEPENDS tests/cuda/*.cu tests/cuda/*.cpp)
  add_executable(cuda_tests ${cuda_test_sources})
  set_target_properties(cuda_tests PROPERTIES UNITY_BUILD OFF)
  # No contraction to fused multiply-add, as on the CPU: what both compute from one source has the
  # same bits.
  # So these sources must make no kernel that pliant_cuda has too (DeviceSolver<CudaExecutor>): of two
  # versions of one the linker takes either, and a batch is not what its scenes are alone.
  target_compile_options(cuda_tests PRIVATE "$<$<COMPILE_LANGUAGE:CUDA>:-fmad=false>")
  target_link_libraries(cuda_tests PRIVATE test_support pliant_cuda GTest::gtest_main)
  # Without a GPU every test says that it skips, and why.
  pliant_add_suites(cuda_tests cuda)
endif()
