# Benchmarks; bullet_bench needs Bullet (scripts/setup --bench), a peer to compare with.
add_executable(cloth_bench bench/cloth_bench.cpp)
target_link_libraries(cloth_bench PRIVATE pliant_core benchmark::benchmark)

add_executable(cloth_elements_bench bench/cloth_elements_bench.cpp)
target_link_libraries(cloth_elements_bench PRIVATE pliant_core CLI11::CLI11)

add_executable(integration_bench bench/integration_bench.cpp)
target_link_libraries(integration_bench PRIVATE pliant_core CLI11::CLI11)

add_executable(patch_forms bench/patch_forms.cpp)
target_link_libraries(patch_forms PRIVATE pliant_core)

# These take their matrices and scenes from the tests.
if(TARGET test_support)
  foreach(name rotation_bench throughput_bench direct_bench patch_bench)
    add_executable(${name} bench/${name}.cpp)
    target_link_libraries(${name} PRIVATE test_support benchmark::benchmark)
  endforeach()
  target_sources(direct_bench PRIVATE bench/convergence_scenes.cpp)

  add_executable(rotation_sweep bench/rotation_sweep.cpp)
  target_link_libraries(rotation_sweep PRIVATE test_support)

  add_executable(convergence bench/convergence.cpp bench/convergence_scenes.cpp)
  target_link_libraries(convergence PRIVATE test_support CLI11::CLI11)
endif()

pkg_check_modules(BULLET QUIET IMPORTED_TARGET bullet)
if(BULLET_FOUND)
  add_executable(bullet_bench bench/bullet_bench.cpp)
  target_link_libraries(bullet_bench PRIVATE pliant_core benchmark::benchmark PkgConfig::BULLET)
endif()

# They are for who measures: `cmake --build build --target benches`; a plain build and the tests do
# without.
add_custom_target(benches)
foreach(name cloth_bench cloth_elements_bench integration_bench rotation_bench rotation_sweep convergence
    throughput_bench direct_bench patch_bench patch_forms bullet_bench)
  if(TARGET ${name})
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    add_dependencies(benches ${name})
  endif()
endforeach()
