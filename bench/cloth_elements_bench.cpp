// What the elements cost that measure as the fabric: processor time of a step with them over that
// with the others, of one thread. docs/performance.md says how to read it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "hanging_cloth.h"
#include "pliant/core/parallel/parallel.h"

namespace pliant::bench {
namespace {

struct Options {
  int side = 50, steps = 100, pairs = 5;
  std::string solver;
};

struct Way {
  std::string solver;
  ParameterText parameters;
};

const std::vector<Way> kWays = {{"xpbd", {{"iterations", "10"}}},
                                {"chebyshev", {{"iterations", "40"}}},
                                {"lbfgs", {{"iterations", "10"}}},
                                {"newton", {{"iterations", "2"}, {"linear_tolerance", "0.03"}}}};

/// A sheet of the default material that hangs by a side, as a grid or as triangles; `named`: with
/// the elements that measure as the fabric.
std::unique_ptr<World> make_sheet(const Options& options, const Way& way, bool is_grid,
                                  bool named) {
  const GridOptions grid{1.0, 1.0, options.side, options.side};
  BodyGeometry geometry;
  geometry.mesh = make_grid(grid);
  if (is_grid) geometry.grid = grid;
  ClothModel::Material material;
  material.areal_density = 0.15;
  material.stretch_warp = material.stretch_weft = 500.0;
  material.shear = 50.0;
  material.bending_warp = material.bending_weft = 1e-5;
  material.warp = {1.0, 0.0, 0.0};
  material.grid_shear = named ? ClothModel::Shear::kCells : ClothModel::Shear::kSprings;
  material.has_plates = named;
  auto world = std::make_unique<World>(0.005);
  Body& body = world->add_body("sheet", std::make_unique<ClothModel>(geometry, material));
  world->add_effect(body, effect_registry(), "gravity", {}, "bench");
  for (int i = 0; i < options.side; ++i) body.particles().fix(i);
  world->set_initial_state();
  world->set_solver(body, solver_registry(), way.solver, way.parameters, "bench");
  return world;
}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double middle(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  return numbers[numbers.size() / 2];
}

/// Steps of both sheets in turn, a few of each at a time, so that what else the machine does falls
/// on both.
void compare(const Options& options, const Way& way, bool is_grid) {
  constexpr int kAtATime = 10;
  std::vector<double> ratios, each;
  for (int pair = 0; pair < options.pairs; ++pair) {
    std::array<std::unique_ptr<World>, 2> sheets;
    std::array<double, 2> seconds{};
    for (std::size_t k = 0; k < 2; ++k) {
      sheets[k] = make_sheet(options, way, is_grid, k == 1);
      sheets[k]->step();
    }
    for (int done = 0; done < options.steps; done += kAtATime) {
      for (std::size_t k = 0; k < 2; ++k) {
        const double start = processor_seconds();
        for (int step = 0; step < kAtATime; ++step) sheets[k]->step();
        seconds[k] += processor_seconds() - start;
      }
    }
    ratios.push_back(seconds[1] / seconds[0]);
    each.push_back(1e3 * seconds[1] / options.steps);
  }
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  fmt::print("{:10} {:5} {:.3f} ({:.3f} to {:.3f}), {:.3f} ms a step\n", way.solver,
             is_grid ? "grid" : "mesh", middle(ratios), *least, *most, middle(each));
}

}  // namespace
}  // namespace pliant::bench

int main(int argc, char** argv) {
  using namespace pliant::bench;
  Options options;
  CLI::App app("cells over springs of a grid, plates over hinges of a mesh");
  app.add_option("--side", options.side, "vertices along each side")->check(CLI::Range(3, 1000));
  app.add_option("--steps", options.steps, "steps of each sheet, in tens")
      ->check(CLI::Range(10, 100000));
  app.add_option("--pairs", options.pairs, "pairs of sheets")->check(CLI::Range(1, 1000));
  app.add_option("--solver", options.solver, "one alone");
  CLI11_PARSE(app, argc, argv);
  pliant::set_threads(1);
  for (const bool is_grid : {true, false}) {
    for (const Way& way : kWays) {
      if (!options.solver.empty() && options.solver != way.solver) continue;
      compare(options, way, is_grid);
    }
  }
}
