// Momentum of bodies that touch, with iterations that end early: that of the forces, and a word
// where there are too many bodies for it.
#include <gtest/gtest.h>

#include <vector>

#include "pliant/effects/registry.h"
#include "support/measures.h"
#include "support/solvers/system_model.h"
#include "support/worlds/worlds.h"

namespace pliant::momentum_balance_test {
namespace {

/// Rods of two vertices on a stiff spring each, upright on a floor that they touch.
std::unique_ptr<World> rods(int count, const std::string& solver, double height = 0.0009) {
  Positions x(3, 2 * count);
  std::vector<Spring> springs;
  for (int k = 0; k < count; ++k) {
    x.col(2 * k) = Eigen::Vector3d(0.3 * k, 0.0, height);
    x.col(2 * k + 1) = Eigen::Vector3d(0.3 * k, 0.0, height + 0.1);
    springs.push_back({2 * k, 2 * k + 1, 0.1, 1e6});
  }
  auto world = std::make_unique<World>(0.005);
  world->add_obstacle(obstacle(Plane()));
  auto model = std::make_unique<SystemModel>(x, 0.1);
  model->add("stretch", springs);
  Body& body = world->add_body("rods", std::move(model));
  world->add_effect(body, effect_registry(), "gravity", {}, "test");
  world->add_effect(body, effect_registry(), "contact", {{"thickness", "0.001"}}, "test");
  world->set_solver(body, solver_registry(), solver, {{"iterations", "2"}}, "test");
  world->set_initial_state();
  return world;
}

// The floor feels the weight, and nothing is left in the velocities.
TEST(MomentumBalance, HoldsTheWeightOfStiffBodiesWithTwoIterations) {
  for (const char* solver : {"jacobi", "chebyshev", "gauss_seidel", "hybrid"}) {
    // More than one matrix is made for, too.
    for (const int count : {3, 30}) {
      SCOPED_TRACE(std::string(solver) + " " + std::to_string(count));
      const auto world = rods(count, solver);
      for (int k = 0; k < 20; ++k) ASSERT_TRUE(world->step()) << world->failure();
      const double weight = 9.81 * particles_of(*world).mass.sum();
      EXPECT_NEAR(-world->reactions()[0].force.z(), weight, 1e-6 * weight);
      EXPECT_LE(particles_of(*world).v.colwise().norm().maxCoeff(), 1e-3);
    }
  }
}

}  // namespace
}  // namespace pliant::momentum_balance_test
