// What holds for every solver of the registry.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/worlds/worlds.h"

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

}  // namespace
}  // namespace pliant
