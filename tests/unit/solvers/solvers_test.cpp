#include <gtest/gtest.h>

#include <algorithm>

#include "support/worlds.h"

namespace pliant {
namespace {

class ASolver : public EverySolver {
 protected:
  ClothScene scene() const {
    ClothScene scene;
    scene.solver = GetParam();
    scene.material = soft_material();
    scene.time_step = 1e-3;
    return scene;
  }
};
PLIANT_FOR_EVERY_SOLVER(ASolver);

TEST_P(ASolver, IsCalledWhatTheRegistrySays) {
  auto world = make_world(scene());
  EXPECT_EQ(body_of(*world).solver->name(), GetParam());
  ASSERT_TRUE(world->step());
  EXPECT_EQ(body_of(*world).report.solver, GetParam());
}

TEST_P(ASolver, LeavesRestAlone) {
  auto world = make_world(scene());
  const Positions rest = particles_of(*world).x;
  run_for(*world, 0.1);
  // Round-off of lengths, 1e-17 m, with 100 steps to grow in.
  EXPECT_LE((particles_of(*world).x - rest).cwiseAbs().maxCoeff(), 1e-14);
}

TEST_P(ASolver, NeverMovesFixedParticles) {
  ClothScene s = scene();
  s.fixed = {0, 3, 24, 48};
  s.effects = {{"gravity", {}}, {"damping", {}}};
  auto world = make_world(s);
  const Positions rest = particles_of(*world).x;
  run_for(*world, 0.2);
  for (int i : s.fixed) {
    EXPECT_EQ(particles_of(*world).x.col(i), rest.col(i));
    EXPECT_TRUE(particles_of(*world).v.col(i).isZero(0.0));
  }
  EXPECT_GT((particles_of(*world).x - rest).norm(), 1e-3);
}

TEST_P(ASolver, MovesFixedParticlesOnlyAsTheUserDoes) {
  ClothScene s = scene();
  s.fixed = {0};
  auto world = make_world(s);
  particles_of(*world).x.col(0) += Eigen::Vector3d(0, 0, 0.01);
  const Eigen::Vector3d put = particles_of(*world).x.col(0);
  ASSERT_TRUE(world->step());
  EXPECT_EQ(particles_of(*world).x.col(0), put);
  EXPECT_GT(particles_of(*world).x(2, 1), 0.0);
}

TEST_P(ASolver, AllFixedStandsStill) {
  ClothScene s = scene();
  for (int i = 0; i < 49; ++i) s.fixed.push_back(i);
  s.effects = {{"gravity", {}}};
  auto world = make_world(s);
  const Positions rest = particles_of(*world).x;
  run_for(*world, 0.05);
  EXPECT_EQ(particles_of(*world).x, rest);
}

TEST_P(ASolver, VelocityIsTheDisplacementOverTheStep) {
  ClothScene s = scene();
  s.effects = {{"gravity", {}}};
  auto world = make_world(s);
  run_for(*world, 0.02);
  const Particles& p = particles_of(*world);
  EXPECT_EQ(p.v, ((p.x - p.x_start) / s.time_step).eval());
}

TEST_P(ASolver, ReportsItsPhases) {
  ClothScene s = scene();
  s.effects = {{"gravity", {}}};
  auto world = make_world(s);
  ASSERT_TRUE(world->step());
  const StepReport& report = body_of(*world).report;
  for (const char* name : {"predict", "velocity", "gravity"}) {
    const auto same = [&](const PhaseTime& phase) { return phase.name == name; };
    EXPECT_EQ(std::count_if(report.phases.begin(), report.phases.end(), same), 1) << name;
  }
  double sum = 0.0;
  for (const PhaseTime& phase : report.phases) sum += phase.seconds;
  EXPECT_LE(sum, report.seconds);
  EXPECT_EQ(report.step, 1u);
  EXPECT_EQ(report.dt, s.time_step);
}

TEST(Verlet, WarnsAboveTheStepThatIsSurelyStable) {
  const auto warnings = [](double dt) {
    ClothScene scene;
    scene.solver = "verlet";
    scene.grid = {0.3, 0.3, 2, 2};
    scene.material = {{"shear", "0"}, {"bending", "0"}};
    scene.time_step = dt;
    auto world = make_world(scene);
    EXPECT_TRUE(world->step());
    return body_of(*world).report.warnings;
  };
  // The lightest corner weighs A/3 of one triangle, 0.15 * 0.045 / 3 kg; its two springs of 250 N/m
  // give row sums of 1000 N/m: h = 2 sqrt(m / 1000).
  const double limit = 2.0 * std::sqrt(0.15 * 0.045 / 3.0 / 1000.0);
  EXPECT_TRUE(warnings(0.999 * limit).empty());
  const auto above = warnings(1.001 * limit);
  ASSERT_EQ(above.size(), 1u);
  EXPECT_NE(above[0].find("unstable_step"), std::string::npos);
  EXPECT_NE(above[0].find("largest step"), std::string::npos);
}

TEST(Verlet, WithoutSpringsAnyStepIsStable) {
  ClothScene scene;
  scene.solver = "verlet";
  scene.time_step = 1.0;
  scene.material = {
      {"stretch_warp", "0"}, {"stretch_weft", "0"}, {"shear", "0"}, {"bending", "0"}};
  auto world = make_world(scene);
  ASSERT_TRUE(world->step());
  EXPECT_TRUE(body_of(*world).report.warnings.empty());
}

/// Value of the implicit Euler objective, sum 1/2 m |x - y|² / h² + E(x), after one step.
double objective_after(int iterations) {
  ClothScene scene;
  scene.solver = "jacobi";
  scene.fixed = {0, 6};
  scene.time_step = 0.02;
  scene.effects = {{"gravity", {}}};
  scene.solver_parameters = {{"iterations", std::to_string(iterations)}};
  auto world = make_world(scene);
  Particles& p = particles_of(*world);
  for (int i = 0; i < p.size(); ++i) p.v(2, i) = p.is_fixed(i) ? 0.0 : -0.05 * (i % 7);
  const Eigen::Matrix3Xd v = p.v;
  const double h = scene.time_step;
  EXPECT_TRUE(world->step());
  double sum = body_of(*world).model->elastic_energy();
  for (int i = 0; i < p.size(); ++i) {
    if (p.is_fixed(i)) continue;
    const Eigen::Vector3d y = p.x_start.col(i) + h * v.col(i) + h * h * Eigen::Vector3d(0, 0, -9.81);
    sum += 0.5 * p.mass[i] * (p.x.col(i) - y).squaredNorm() / (h * h);
  }
  return sum;
}

TEST(Jacobi, NoIterationRaisesTheObjective) {
  double last = objective_after(0);
  for (const int iterations : {1, 2, 3, 5, 10, 50, 200}) {
    const double value = objective_after(iterations);
    EXPECT_LE(value, last * (1.0 + 1e-14)) << iterations;
    last = value;
  }
}

}  // namespace
}  // namespace pliant
