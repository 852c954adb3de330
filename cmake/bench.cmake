# Benchmarks; bullet_bench needs Bullet (scripts/setup --bench), a peer to compare with.
add_executable(cloth_bench bench/cloth_bench.cpp)
target_link_libraries(cloth_bench PRIVATE pliant_core benchmark::benchmark)

# Both take their matrices from the tests.
add_executable(rotation_bench bench/rotation_bench.cpp)
target_include_directories(rotation_bench PRIVATE tests)
target_link_libraries(rotation_bench PRIVATE pliant_core benchmark::benchmark)

add_executable(rotation_sweep bench/rotation_sweep.cpp)
target_include_directories(rotation_sweep PRIVATE tests)
target_link_libraries(rotation_sweep PRIVATE pliant_core)

add_executable(convergence bench/convergence.cpp bench/convergence_scenes.cpp)
target_include_directories(convergence PRIVATE tests)
target_link_libraries(convergence PRIVATE pliant_core CLI11::CLI11)

foreach(name throughput_bench direct_bench patch_bench)
  add_executable(${name} bench/${name}.cpp)
  target_include_directories(${name} PRIVATE tests)
  target_link_libraries(${name} PRIVATE pliant_core benchmark::benchmark)
endforeach()
target_sources(direct_bench PRIVATE bench/convergence_scenes.cpp)

pkg_check_modules(BULLET QUIET IMPORTED_TARGET bullet)
if(BULLET_FOUND)
  add_executable(bullet_bench bench/bullet_bench.cpp)
  target_link_libraries(bullet_bench PRIVATE pliant_core benchmark::benchmark PkgConfig::BULLET)
endif()

# They are for who measures: `cmake --build build --target benches`; a plain build and the tests do
# without.
add_custom_target(benches)
foreach(name cloth_bench rotation_bench rotation_sweep convergence throughput_bench direct_bench
    patch_bench bullet_bench)
  if(TARGET ${name})
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    add_dependencies(benches ${name})
  endif()
endforeach()
