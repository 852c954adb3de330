// Bodies of the model `patch` from the worst states, moved by whole solvers: all come back to rest.
#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"
#include "support/worlds/patch_worlds.h"

namespace pliant::patch_recovery_test {
namespace {

constexpr double kRadius = 0.05;
constexpr double kRested = 1e-3;  // strain
constexpr double kSlow = 1e-4;    // [m/s]

PatchScene soft_ball(const std::string& solver) {
  PatchScene scene;
  scene.options = {{"tetrahedra", "300"}};
  scene.effects = {{"damping", {{"rate", "20"}}}};
  scene.solver = solver;
  scene.solver_parameters = {{"iterations", "50"}};
  return scene;
}

class PatchRecovery : public ::testing::TestWithParam<std::string> {
 protected:
  /// Steps until it rests; largest strain of a vertex then.
  double recovered_strain(World& world) {
    Particles& particles = particles_of(world);
    particles.x_start = particles.x;
    double strain = INFINITY;
    for (int step = 1; step <= 400; ++step) {
      EXPECT_TRUE(world.step()) << world.failure();
      if (step % 20 != 0) continue;
      strain = body_of(world).model->point_fields().at("strain").maxCoeff();
      if (strain < kRested && particles.v.colwise().norm().maxCoeff() < kSlow) break;
    }
    return strain;
  }
};

TEST_P(PatchRecovery, SqueezedFlat) {
  auto world = make_world(soft_ball(GetParam()));
  particles_of(*world).x.row(2) *= 1e-3;
  EXPECT_LT(recovered_strain(*world), kRested);
}

TEST_P(PatchRecovery, TurnedInsideOut) {
  auto world = make_world(soft_ball(GetParam()));
  particles_of(*world).x.row(0) *= -1.0;
  EXPECT_LT(recovered_strain(*world), kRested);
}

TEST_P(PatchRecovery, Scrambled) {
  auto world = make_world(soft_ball(GetParam()));
  Random random(11);
  particles_of(*world).x = random.positions(particles_of(*world).size(), kRadius);
  EXPECT_LT(recovered_strain(*world), kRested);
}

INSTANTIATE_TEST_SUITE_P(Solvers, PatchRecovery,
                         ::testing::Values("chebyshev", "direct", "lbfgs", "newton"));

}  // namespace
}  // namespace pliant::patch_recovery_test
