// Cloth: node-iterations of xpbd, steps of verlet, memory. docs/performance.md says how to read it.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include "hanging_cloth.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/geometry/distance/primitive_shapes.h"

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
HangingCloth thesis_cloth(int side) {
  HangingCloth options;
  options.side = side;
  options.size = 0.3;
  options.areal_density = 0.1;
  options.stretch = 100.0;
  options.shear = 10.0;
  options.diagonals = 2;
  options.time_step = 1.0 / 12000.0 * 49.0 / (side - 1);
  options.solver = "verlet";
  options.solver_parameters = {{"contact_sweeps", "1"}};  // as in the thesis
  return options;
}

void count_steps(benchmark::State& state) {
  const double nodes = static_cast<double>(state.range(0)) * static_cast<double>(state.range(0));
  const auto steps = static_cast<double>(state.iterations());
  state.counters["steps"] = benchmark::Counter(steps, benchmark::Counter::kIsRate);
  state.counters["node_steps"] = benchmark::Counter(nodes * steps, benchmark::Counter::kIsRate);
}

// On a plane with friction and 400 cm³ of sealed air, the middle pulled up; all that the thesis has
// where the cloth touches itself as well.
void thesis_scene(benchmark::State& state) {
  const HangingCloth options = thesis_cloth(static_cast<int>(state.range(0)));
  auto world = make_cloth(options);
  Obstacle plane;
  plane.name = "plane";
  plane.shape = std::make_shared<Plane>();
  world->add_obstacle(plane);
  Body& body = world->bodies().front();
  body.particles().x.row(2).array() += 0.001;
  const ParameterText air = {{"volume", "4e-4"}, {"seal_breaks", "false"}, {"fill_time", "0.1"}};
  world->add_effect(body, effect_registry(), "air", air, "bench");
  if (state.range(1) != 0) world->add_effect(body, effect_registry(), "self_contact", {}, "bench");
  world->add_effect(body, effect_registry(), "contact", {}, "bench");
  world->add_effect(body, effect_registry(), "friction", {}, "bench");
  world->add_effect(body, effect_registry(), "damping", {{"rate", "5"}}, "bench");
  const int middle = options.side * (options.side / 2) + options.side / 2;
  body.particles().fix(middle);
  start(*world, options);
  const auto lift_and_step = [&] {
    double& height = body.particles().x(2, middle);
    height = std::min(0.05, height + 0.1 * options.time_step);
    if (!world->step()) state.SkipWithError(body.report.failure.c_str());
  };
  while (world->time() < 0.2) lift_and_step();
  for (auto _ : state) lift_and_step();
  count_steps(state);
}
BENCHMARK(thesis_scene)
    ->ArgNames({"side", "self_contact"})
    ->ArgsProduct({{10, 20, 30, 40, 50, 100, 200}, {0, 1}});

void thesis_springs_only(benchmark::State& state) {
  const auto world = make_hanging_cloth(thesis_cloth(static_cast<int>(state.range(0))));
  for (auto _ : state) {
    if (!world->step()) state.SkipWithError("not finite");
  }
  count_steps(state);
}
BENCHMARK(thesis_springs_only)->ArgName("side")->Arg(50)->Arg(200);

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
