# Benchmarks; bullet_bench needs Bullet (scripts/setup --bench), a peer to compare with.
add_executable(cloth_bench bench/cloth_bench.cpp)
target_link_libraries(cloth_bench PRIVATE pliant_core benchmark::benchmark)

pkg_check_modules(BULLET QUIET IMPORTED_TARGET bullet)
if(BULLET_FOUND)
  add_executable(bullet_bench bench/bullet_bench.cpp)
  target_link_libraries(bullet_bench PRIVATE pliant_core benchmark::benchmark PkgConfig::BULLET)
endif()
