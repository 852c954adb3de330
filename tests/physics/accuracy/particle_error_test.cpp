// The error that steps of bodies of particles report against the error that they have, as
// error_estimate_test.cpp does it for tetrahedra; and what solvers agree on at convergence.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pliant/scene/scene.h"
#include "support/measures.h"
#include "support/random.h"
#include "support/rms_distance.h"

namespace pliant::particle_error_test {
namespace {

constexpr double kSlope = 0.75;  // the tangent of its angle
const double kCos = 1.0 / std::sqrt(1.0 + kSlope * kSlope), kSin = kSlope * kCos;

struct RandomScene {
  std::string text, solver, iterations;
};

/// Blocks, beams and balls, clamped, thrown or on a slope, of 1e4 to 1e8 Pa or rigid, of plain and
/// of oriented particles, with a random solver and number of iterations.
RandomScene random_scene(std::uint64_t seed) {
  Random random(seed);
  const auto pick = [&](int count) { return static_cast<int>(random(0.0, count)); };
  const double young = std::pow(10.0, random(4.0, 8.0));
  const double time_step = std::pow(10.0, random(-2.7, -2.0));
  const int shape = pick(3);
  const bool clamped = shape == 1 && pick(2) == 0, thrown = !clamped && pick(2) == 0;
  const Eigen::Vector3d velocity = thrown ? random.vector(1.0) : Eigen::Vector3d(0, 0, 0);
  const char* shapes[] = {"block: {size: [0.1, 0.1, 0.05]}", "block: {size: [0.3, 0.05, 0.05]}",
                          "sphere: {radius: 0.05}"};
  const double height = clamped ? 0.4 : (shape == 2 ? 0.0512 : 0.0262);
  const double drop = thrown ? random(0.0, 0.1) : 0.0;
  const double fraction = pick(2) == 1 ? 1.0 : 0.3;
  const double density = random(200, 2000);
  const char* state = pick(4) == 0 ? "rigid" : "elastic";
  const bool oriented = pick(4) == 0;
  const std::vector<std::string> solvers = {"chebyshev", "direct", "gauss_seidel", "jacobi",
                                            "lbfgs",     "newton", "xpbd"};
  RandomScene result;
  result.solver = solvers[static_cast<std::size_t>(pick(static_cast<int>(solvers.size())))];
  const int iterations = static_cast<int>(std::pow(2.0, random(1.0, 7.0)));
  result.iterations = std::to_string(result.solver == "newton" ? 20 : iterations);
  result.text = fmt::format(
      "time_step: {}\nbodies:\n  - name: body\n    model: viscoelastic\n"
      "    geometry: {{{}, spacing: 0.0125}}\n    position: [0, 0, {}]\n"
      "    velocity: [{}, {}, {}]\n    material: {{state: {}, young: {}, density: {}, "
      "cluster_fraction: {}, oriented: {}}}\n",
      time_step, shapes[shape], height + drop, velocity[0], velocity[1], velocity[2], state, young,
      density, fraction, oriented);
  if (clamped) {
    result.text += "    fixed:\n      - box: {min: [-1, -1, -1], max: [-0.135, 1, 1]}\n";
    result.text += "effects:\n  gravity: {acceleration: [0, 0, -9.81]}\n";
  } else {
    result.text += fmt::format(
        "obstacles:\n  - {{name: slope, shape: plane, friction: 0.5}}\n"
        "effects:\n  gravity: {{acceleration: [{}, 0, {}]}}\n"
        "  contact: {{thickness: 0.001}}\n  friction: {{coefficient: 0.5}}\n",
        9.81 * kSin, -9.81 * kCos);
  }
  return result;
}

LoadedScene load(const std::string& text, const std::string& solver,
                 const ParameterText& parameters) {
  SceneOverrides overrides;
  overrides.text = text;
  overrides.solver = solver;
  overrides.solver_parameters = parameters;
  return load_scene("scene.yaml", overrides);
}

const Body& body_of(const LoadedScene& scene) { return scene.world->bodies().front(); }

struct Outcome {
  double error = 0.0, estimate = 0.0;
  bool is_warned = false;
};

Outcome measure(const RandomScene& r) {
  const LoadedScene scene = load(r.text, r.solver, {{"iterations", r.iterations}});
  const LoadedScene exact =
      load(r.text, "newton",
           {{"iterations", "60"}, {"tolerance", "1e-7"}, {"linear_tolerance", "1e-3"}});
  for (const LoadedScene* each : {&scene, &exact}) run_for(*each->world, 0.3);
  const Particles& p = body_of(exact).particles();
  const Positions& first = body_of(exact).initial.x;
  const Eigen::Vector3d center = first * p.mass / p.mass.sum();
  const double size = rms_distance(p, first, center.replicate(1, p.size()));
  const double travel = std::max(rms_distance(p, p.x, first), 0.01 * size);
  Outcome outcome;
  outcome.error = rms_distance(p, body_of(scene).particles().x, p.x) / travel;
  EXPECT_TRUE(body_of(scene).report.error.has_value());
  outcome.estimate = body_of(scene).report.error.value_or(-1.0);
  outcome.is_warned = warns(*scene.world, "inaccurate");
  return outcome;
}

constexpr int kScenes = 60;

TEST(ParticleError, IsLargeEnoughInRandomScenesAndSeldomWarnsOfNothing) {
  int too_small = 0, needless = 0, missing = 0;
  std::string wrong;
  for (int k = 0; k < kScenes; ++k) {
    const RandomScene r = random_scene(static_cast<std::uint64_t>(k));
    const Outcome o = measure(r);
    // As in error_estimate_test.cpp.
    const bool is_small = std::min(1.0, o.error) > std::max(3.0 * o.estimate, 1e-3);
    const bool is_needless = o.is_warned && o.error < 0.02;
    const bool is_missing = !o.is_warned && o.error > 0.1;
    too_small += is_small;
    needless += is_needless;
    missing += is_missing;
    if (!is_small && !is_needless && !is_missing) continue;
    wrong += fmt::format("scene {}: {} {}: error {}, estimate {}\n", k, r.solver, r.iterations,
                         o.error, o.estimate);
  }
  RecordProperty("too_small", too_small);
  RecordProperty("missing", missing);
  RecordProperty("needless", needless);
  EXPECT_LE(too_small, kScenes / 20) << wrong;
  EXPECT_LE(missing, kScenes / 20) << wrong;
  EXPECT_LE(needless, kScenes / 20) << wrong;
}

// A liquid's forces hold what lies in it, and no matrix knows: an error that was estimated without
// them would be several times too large.
TEST(ParticleError, IsNoneWhereALiquidFlows) {
  const std::string text =
      "time_step: 0.005\nbodies:\n  - name: body\n    model: viscoelastic\n"
      "    geometry: {block: {size: [0.05, 0.05, 0.05]}, spacing: 0.0125}\n"
      "    material: {state: viscoelastic, beta: 0.3, young: 1e4}\n"
      "effects:\n  gravity: {}\n";
  const LoadedScene scene = load(text, "jacobi", {{"iterations", "5"}});
  run_for(*scene.world, 0.02);
  EXPECT_FALSE(body_of(scene).report.error.has_value());
}

// Clusters have a torque on the positions of oriented particles, which turns these particles. No
// solver may take it for angular momentum that its iterations lost.
TEST(ParticleError, SolversAgreeOnOrientedParticlesAtConvergence) {
  for (const char* friction : {"0", "0.5"}) {
    const std::string text = fmt::format(
        "time_step: 0.008\nbodies:\n  - name: body\n    model: viscoelastic\n"
        "    geometry: {{sphere: {{radius: 0.05}}, spacing: 0.0125}}\n"
        "    position: [0, 0, 0.0515]\n    velocity: [0.3, 0, 0]\n"
        "    material: {{state: elastic, young: 2e4, oriented: true}}\n"
        "obstacles:\n  - {{name: slope, shape: plane, friction: {0}}}\n"
        "effects:\n  gravity: {{acceleration: [{1}, 0, {2}]}}\n"
        "  contact: {{thickness: 0.001}}\n  friction: {{coefficient: {0}}}\n",
        friction, 9.81 * kSin, -9.81 * kCos);
    const LoadedScene exact = load(text, "newton", {{"iterations", "60"}, {"tolerance", "1e-9"}});
    run_for(*exact.world, 0.08);
    const Particles& p = body_of(exact).particles();
    const double travel = rms_distance(p, p.x, body_of(exact).initial.x);
    ASSERT_GT(travel, 0.03);
    for (const char* solver : {"direct", "lbfgs", "jacobi", "chebyshev", "gauss_seidel"}) {
      const LoadedScene other = load(text, solver, {{"iterations", "2000"}, {"tolerance", "1e-9"}});
      run_for(*other.world, 0.08);
      EXPECT_LT(rms_distance(p, body_of(other).particles().x, p.x), 1e-7 * travel)
          << solver << ", friction " << friction;
      EXPECT_LT(body_of(other).report.impulse_imbalance.value(), 1e-7) << solver;
    }
  }
}

}  // namespace
}  // namespace pliant::particle_error_test
