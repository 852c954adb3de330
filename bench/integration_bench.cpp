// What a tip error costs by each time integration: a beam is released where it is straight and
// swings; the mean position of its end is compared, at every step, with that of a run by `midpoint`
// with small steps. The error is the largest distance over the end's largest displacement.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pliant/core/body.h"
#include "pliant/math/error.h"
#include "pliant/scene/scene.h"

namespace pliant::bench {
namespace {

struct Options {
  std::string scene = "bench/scenes/swinging_cantilever.yaml";
  double seconds = 0.32;
  double reference_step = 1e-3;
  std::vector<std::string> runs;
};

struct Swing {
  double dt = 0.0;                    // [s]
  std::vector<Eigen::Vector3d> tips;  // after each step, from the start on [m]
  double seconds = 0.0;               // of processing
  int iterations = 0;                 // of all steps
};

Swing swing(const Options& options, const std::string& integration, double dt) {
  SceneOverrides overrides;
  overrides.time_integration = integration;
  overrides.time_step = dt;
  overrides.threads = 1;
  const LoadedScene scene = load_scene(options.scene, overrides);
  World& world = *scene.world;
  const Body& body = world.bodies().front();
  const Particles& p = body.particles();
  const double end = p.x.row(0).maxCoeff() - 1e-6;
  std::vector<int> tip;
  for (int i = 0; i < p.size(); ++i) {
    if (p.x(0, i) > end) tip.push_back(i);
  }
  const auto mean = [&] { return Eigen::Vector3d(p.x(Eigen::all, tip).rowwise().mean()); };
  Swing result;
  result.dt = dt;
  result.tips.push_back(mean());
  while (world.time() < options.seconds - 1e-9) {
    if (!world.step()) throw InputError(world.failure());
    result.tips.push_back(mean());
    result.seconds += body.report.seconds;
    result.iterations += body.report.iterations;
  }
  return result;
}

/// Between steps along the cubic through the four around [m].
Eigen::Vector3d tip_at(const Swing& swing, double time) {
  const int last = static_cast<int>(swing.tips.size()) - 1;
  const int first = std::clamp(static_cast<int>(time / swing.dt) - 1, 0, std::max(0, last - 3));
  const int count = std::min(4, last + 1 - first);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int a = 0; a < count; ++a) {
    double weight = 1.0;
    for (int b = 0; b < count; ++b) {
      if (b != a) weight *= (time / swing.dt - first - b) / (a - b);
    }
    sum += weight * swing.tips[static_cast<std::size_t>(first + a)];
  }
  return sum;
}

double error_of(const Swing& swing, const Swing& reference) {
  double travel = 0.0, error = 0.0;
  for (const auto& tip : reference.tips) {
    travel = std::max(travel, (tip - reference.tips[0]).norm());
  }
  for (std::size_t k = 0; k < swing.tips.size(); ++k) {
    const Eigen::Vector3d exact = tip_at(reference, static_cast<double>(k) * swing.dt);
    error = std::max(error, (swing.tips[k] - exact).norm());
  }
  return error / travel;
}

void tell(const std::string& name, const Swing& run, const Swing& reference) {
  fmt::print("{:16} {:8.3f} {:6} {:8.2f} {:10.2f} {:8}\n", name, 1e3 * run.dt, run.tips.size() - 1,
             100.0 * error_of(run, reference), run.seconds, run.iterations);
  std::fflush(stdout);
}

void measure(const Options& options) {
  const Swing reference = swing(options, "midpoint", options.reference_step);
  fmt::print("{:16} {:>8} {:>6} {:>8} {:>10} {:>8}\n", "", "dt [ms]", "steps", "error %",
             "time [s]", "iterations");
  tell("the reference", reference, reference);
  tell("at twice its dt", swing(options, "midpoint", 2.0 * options.reference_step), reference);
  for (const std::string& run : options.runs) {
    const auto colon = run.find(':');
    if (colon == std::string::npos) throw InputError("'" + run + "' is not INTEGRATION:SECONDS");
    const std::string name = run.substr(0, colon);
    tell(name, swing(options, name, std::stod(run.substr(colon + 1))), reference);
  }
}

}  // namespace
}  // namespace pliant::bench

int main(int argc, char** argv) {
  pliant::bench::Options options;
  CLI::App app("Tip error of a swinging beam, steps and time by each time integration.");
  app.add_option("--scene", options.scene, "a beam along x that is held at its lower end");
  app.add_option("--seconds", options.seconds, "of the swing")->check(CLI::PositiveNumber);
  app.add_option("--reference-step", options.reference_step, "[s]")->check(CLI::PositiveNumber);
  app.add_option("runs", options.runs, "INTEGRATION:STEP, the step in s")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    pliant::bench::measure(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "integration_bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
