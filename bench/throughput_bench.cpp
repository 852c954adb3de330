// Time and memory traffic of one iteration, beside what this machine's memory gives in the same
// run.
#include <benchmark/benchmark.h>

#include <map>

#include "pliant/core/parallel/parallel.h"
#include "pliant/effects/registry.h"
#include "pliant/elements/solids/tetrahedron_set.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/models/cloth/cloth_springs.h"
#include "support/solvers/system_model.h"
#include "support/worlds/solids.h"

namespace pliant::bench {
namespace {

constexpr int kIterations = 10;
constexpr double kStep = 0.01;  // [s]

/// a = b + s c over arrays that no cache holds (STREAM's triad): three doubles an entry.
void triad(benchmark::State& state) {
  set_threads(static_cast<int>(state.range(0)));
  constexpr int kSize = 1 << 24;
  Eigen::VectorXd a = Eigen::VectorXd::Zero(kSize), b = a, c = a;
  for (auto _ : state) {
    parallel_for(0, kSize, 1 << 16, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) a[i] = b[i] + 3.0 * c[i];
    });
    benchmark::ClobberMemory();
  }
  state.counters["bytes"] = benchmark::Counter(
      24.0 * kSize * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  set_threads(1);
}
BENCHMARK(triad)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime();

struct Case {
  std::unique_ptr<World> world;
  double elements;
  double bytes;  // least traffic of one iteration
};

std::unique_ptr<World> world_with(std::unique_ptr<SystemModel> model, const std::string& solver) {
  auto world =
      world_of(std::move(model), kStep, solver, {{"iterations", std::to_string(kIterations)}});
  world->add_effect(world->bodies().front(), effect_registry(), "gravity", {}, "bench");
  return world;
}

// What an iteration cannot do without, each byte once: a vertex's position, force, prediction and
// three coefficients are read, its position and force written.
constexpr double kBytesPerVertex = 8.0 * (3 + 3 + 3 + 3 + 3 + 3);

Case springs(int side, const std::string& solver) {
  const GridOptions grid{1.0, 1.0, side, side};
  auto model = std::make_unique<SystemModel>(make_grid(grid).vertices, 1e-4);
  std::vector<Spring> all = grid_stretch_springs(grid, {1e3, 1e3, 0.0});
  const std::vector<Spring> shear = grid_shear_springs(grid, 100.0, 1);
  all.insert(all.end(), shear.begin(), shear.end());
  const auto count = static_cast<double>(all.size());
  model->add("stretch", all);
  model->particles().fix(0);
  return {world_with(std::move(model), solver), count,
          sizeof(Spring) * count + kBytesPerVertex * side * side};
}

Case tetrahedra(int cells, const std::string& solver) {
  BlockOptions block;
  block.cells = Eigen::Vector3i::Constant(cells);
  const TetrahedralMesh mesh = make_block(block);
  const Eigen::VectorXd masses = 1000.0 * vertex_volumes(mesh);
  auto model = std::make_unique<SystemModel>(mesh.vertices, masses);
  auto& system = static_cast<ProjectiveSystem&>(model->system());
  system.elements.push_back(std::make_unique<TetrahedronSet>(mesh, 1e5));
  model->particles().fix(0);
  const auto count = static_cast<double>(mesh.tetrahedra.cols());
  // Four indices, the inverse of the rest edges and the weight.
  return {world_with(std::move(model), solver), count,
          (4.0 * 4.0 + 9.0 * 8.0 + 8.0) * count +
              kBytesPerVertex * static_cast<double>(mesh.vertices.cols())};
}

void measure(benchmark::State& state, Case a_case) {
  set_threads(static_cast<int>(state.range(1)));
  for (int k = 0; k < 3; ++k) a_case.world->step();
  for (auto _ : state) a_case.world->step();
  const double iterations = kIterations * static_cast<double>(state.iterations());
  using benchmark::Counter;
  state.counters["element_iterations"] = Counter(a_case.elements * iterations, Counter::kIsRate);
  state.counters["iteration"] = Counter(iterations, Counter::kIsRate | Counter::kInvert);
  state.counters["bytes"] = Counter(a_case.bytes * iterations, Counter::kIsRate);
  set_threads(1);
}

void spring_iteration(benchmark::State& state, const std::string& solver) {
  measure(state, springs(static_cast<int>(state.range(0)), solver));
}
void tetrahedron_iteration(benchmark::State& state, const std::string& solver) {
  measure(state, tetrahedra(static_cast<int>(state.range(0)), solver));
}

// About 10,000, 100,000 and 1,000,000 elements.
void sizes_of_grids(benchmark::internal::Benchmark* b) {
  for (const int side : {58, 183, 578}) {
    for (const int threads : {1, 2}) b->Args({side, threads});
  }
  b->ArgNames({"side", "threads"})->UseRealTime()->Unit(benchmark::kMillisecond);
}
void sizes_of_blocks(benchmark::internal::Benchmark* b) {
  for (const int cells : {12, 27, 58}) {
    for (const int threads : {1, 2}) b->Args({cells, threads});
  }
  b->ArgNames({"cells", "threads"})->UseRealTime()->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(spring_iteration, jacobi, "jacobi")->Apply(sizes_of_grids);
BENCHMARK_CAPTURE(spring_iteration, chebyshev, "chebyshev")->Apply(sizes_of_grids);
BENCHMARK_CAPTURE(spring_iteration, xpbd, "xpbd")->Apply(sizes_of_grids);
BENCHMARK_CAPTURE(spring_iteration, hybrid, "hybrid")->Apply(sizes_of_grids);
BENCHMARK_CAPTURE(tetrahedron_iteration, jacobi, "jacobi")->Apply(sizes_of_blocks);
BENCHMARK_CAPTURE(tetrahedron_iteration, chebyshev, "chebyshev")->Apply(sizes_of_blocks);

}  // namespace
}  // namespace pliant::bench

BENCHMARK_MAIN();
