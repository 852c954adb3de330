// Cloth: node-iterations of xpbd, steps of verlet, memory. docs/performance.md says how to read it.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include "hanging_cloth.h"
#include "pliant/core/parallel.h"

namespace pliant::bench {
namespace {

constexpr int kSettlingSteps = 400;

void hanging_xpbd(benchmark::State& state) {
  set_threads(static_cast<int>(state.range(0)));
  const auto world = make_hanging_cloth({});
  for (int k = 0; k < kSettlingSteps; ++k) world->step();
  for (auto _ : state) world->step();
  const double node_iterations = 2500.0 * 10.0 * static_cast<double>(state.iterations());
  state.counters["node_iterations"] =
      benchmark::Counter(node_iterations, benchmark::Counter::kIsRate);
  const Strain strain = stretch_strain(*world);
  state.counters["strain_mean"] = strain.mean;
  state.counters["strain_max"] = strain.max;
  set_threads(1);
}
BENCHMARK(hanging_xpbd)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime();

// The thesis's cloth: 30 cm, eight springs a node, step 1/12000 s. Fewer or more nodes keep the
// stability number h² k / m of 2,500 nodes.
void thesis_verlet(benchmark::State& state) {
  HangingCloth options;
  options.side = static_cast<int>(state.range(0));
  options.size = 0.3;
  options.areal_density = 0.1;
  options.stretch = 100.0;
  options.shear = 10.0;
  options.diagonals = 2;
  options.time_step = 1.0 / 12000.0 * 49.0 / (options.side - 1);
  options.solver = "verlet";
  options.solver_parameters = {};
  const auto world = make_hanging_cloth(options);
  for (auto _ : state) {
    if (!world->step()) state.SkipWithError("not finite");
  }
  const double nodes = static_cast<double>(options.side) * options.side;
  const auto steps = static_cast<double>(state.iterations());
  state.counters["steps"] = benchmark::Counter(steps, benchmark::Counter::kIsRate);
  state.counters["node_steps"] = benchmark::Counter(nodes * steps, benchmark::Counter::kIsRate);
}
BENCHMARK(thesis_verlet)->ArgName("side")->Arg(10)->Arg(20)->Arg(30)->Arg(40)->Arg(50)->Arg(100)->Arg(200);

void memory_per_node(benchmark::State& state) {
  HangingCloth options;
  options.side = 200;
  options.diagonals = 2;
  std::size_t bytes = 0;
  for (auto _ : state) {
    const std::size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
    const auto world = make_hanging_cloth(options);
    world->step();
    bytes = mallinfo2().uordblks + mallinfo2().hblkhd - before;
  }
  state.counters["bytes_per_node"] = static_cast<double>(bytes) / (200.0 * 200.0);
}
BENCHMARK(memory_per_node)->Iterations(1);

}  // namespace
}  // namespace pliant::bench

BENCHMARK_MAIN();
