// Solids that name no solver, from soft to so stiff that they hardly bend: where they come to when
// they fall on something is within 5 % of what converged steps give, and nothing says otherwise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/rms_distance.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/stiff_cubes.h"
#include "support/worlds/worlds.h"

namespace pliant::default_of_solids_test {
namespace {

constexpr const char* kEffects =
    "effects:\n  gravity: {}\n  contact: {thickness: 0.001}\n  friction: {coefficient: 0.5}\n";
constexpr const char* kExact =
    "solver: {name: newton, iterations: 100, tolerance: 1.0e-6, linear_tolerance: 1.0e-3}\n";

/// Both run for so long; each body is compared.
void expect_agreement(const std::string& scene, double seconds, const std::string& which) {
  const auto world = world_of(scene), exact = world_of(scene + kExact);
  std::vector<Positions> first;
  for (const Body& body : exact->bodies()) first.push_back(body.particles().x);
  while (exact->time() < seconds) {
    ASSERT_TRUE(world->step()) << world->failure();
    ASSERT_TRUE(exact->step()) << exact->failure();
    EXPECT_FALSE(warns(*world, "inaccurate")) << which << " at " << world->time();
    EXPECT_FALSE(warns(*world, "energy_held_back")) << which << " at " << world->time();
  }
  for (std::size_t b = 0; b < first.size(); ++b) {
    const Particles& p = exact->bodies()[b].particles();
    EXPECT_LE(rms_distance(p, world->bodies()[b].particles().x, p.x),
              0.05 * rms_distance(p, p.x, first[b]))
        << which << ", body " << b;
  }
}

// Quasi-Newton corrections, which solids took before, are 20 and 43 % off, told 1 and 7 %.
TEST(DefaultOfSolids, ARodThatFallsOnABar) {
  for (const char* young : {"1e5", "1e6", "1e7", "1e8"}) {
    expect_agreement(
        fmt::format(
            "time_step: 0.005\nbodies:\n  - {{name: rod, model: patch, geometry: {{block: {{size: "
            "[0.4, 0.02, 0.02], cells: [20, 1, 1]}}}}, position: [0, 0, 0.2], rotation_rpy: [0, "
            "0.3, 0.2], material: {{young: {}, poisson: 0.35, density: 1000}}}}\nobstacles:\n"
            "  - {{name: ground, shape: plane}}\n"
            "  - {{name: bar, shape: capsule, radius: 0.02, length: 0.4, position: [0, 0, 0.1], "
            "rotation_rpy: [1.5708, 0, 0]}}\n{}",
            young, kEffects),
        0.8, young);
  }
}

// They were thrown out of it.
TEST(DefaultOfSolids, StiffCubesThatFallIntoABox) {
  expect_agreement(stiff_cubes_in_a_box(0.01), 0.4, "cubes");
}

}  // namespace
}  // namespace pliant::default_of_solids_test
