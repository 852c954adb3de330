// Any number of iterations, any time step: finite, bounded, explained.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/bounds.h"

namespace pliant {
namespace {

class AnyIterations
    : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

INSTANTIATE_TEST_SUITE_P(Solvers, AnyIterations,
                         testing::Combine(testing::Values("xpbd", "jacobi"),
                                          testing::Values("0", "1", "10000")));

TEST_P(AnyIterations, AreBounded) {
  const auto& [solver, iterations] = GetParam();
  for (const double dt : {1e-3, 1.0 / 60}) {
    ClothScene s = on_two_corners(solver, dt);
    s.solver_parameters = {{"iterations", iterations}};
    s.obstacles = {obstacle(Plane(), at(0, 0, -0.2))};
    s.effects.push_back({"contact", {}});
    auto world = make_world(s);
    // Free fall is the fastest it can go, and the plane the end: 0.2 m down, the cloth's half.
    expect_bounded(*world, iterations == "10000" ? 10 : 300, 0.5);
    EXPECT_GE(particles_of(*world).x.row(2).minCoeff(), -0.2);
    EXPECT_EQ(body_of(*world).report.iterations, std::stoi(iterations));
  }
}

TEST(ZeroIterations, AreFreeFall) {
  ClothScene s = on_two_corners("xpbd", 1e-3);
  s.solver_parameters = {{"iterations", "0"}};
  s.effects = {{"gravity", {}}};
  auto world = make_world(s);
  run_for(*world, 0.1);
  EXPECT_NEAR(particles_of(*world).v(2, 20), -0.981, 1e-10);
  EXPECT_EQ(particles_of(*world).v(2, 0), 0.0);
}

class AnyTimeStep : public testing::TestWithParam<std::tuple<std::string, double>> {};

INSTANTIATE_TEST_SUITE_P(Solvers, AnyTimeStep,
                         testing::Combine(testing::Values("xpbd", "jacobi"),
                                          testing::Values(1e-6, 1e-5, 1e-4, 1e-3, 1.0 / 30, 0.1, 1.0)));

TEST_P(AnyTimeStep, IsBoundedForImplicitSolvers) {
  const auto& [solver, dt] = GetParam();
  auto world = make_world(on_two_corners(solver, dt));
  // In one step of 1 s gravity predicts 9.81 m; iterations that do not converge take back a part,
  // and the speed they leave adds to the next step. Energy only falls: no more than a few predictions.
  expect_bounded(*world, 200, 0.5 + 4.0 * 9.81 * dt * dt);
}

TEST_P(AnyTimeStep, IsBoundedWithContactFrictionAndAir) {
  const auto& [solver, dt] = GetParam();
  ClothScene s = on_two_corners(solver, dt);
  s.fixed.clear();
  s.pose = at(0, 0, 0.001);
  s.obstacles = {obstacle(Plane())};
  s.effects = {{"gravity", {}}, {"damping", {}}, {"air", {}}, {"contact", {}}, {"friction", {}}};
  auto world = make_world(s);
  expect_bounded(*world, 100, 0.3);
  EXPECT_GE(particles_of(*world).x.row(2).minCoeff(), 0.001 - 1e-9);
}

class VerletStep : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Steps, VerletStep, testing::Values(1e-6, 1e-5, 1e-4, 1e-3, 1.0 / 30, 0.1, 1.0));

TEST_P(VerletStep, IsBoundedOrWarnsAndRollsBack) {
  auto world = make_world(on_two_corners("verlet", GetParam()));
  bool told = false;
  for (int k = 0; k < 300; ++k) {
    const bool good = world->step();
    told |= warned(*world, "unstable_step");
    ASSERT_TRUE(particles_of(*world).x.allFinite());
    ASSERT_LE(particles_of(*world).v.cwiseAbs().maxCoeff(), world->finite_check().max_speed);
    if (!good) {
      EXPECT_NE(body_of(*world).report.failure.find("smaller"), std::string::npos);
      break;
    }
  }
  // What leaves the neighbourhood was told to be unstable.
  EXPECT_TRUE(told || extent(*world) < 0.6);
  EXPECT_EQ(told, GetParam() >= 1e-3);
}

}  // namespace
}  // namespace pliant
