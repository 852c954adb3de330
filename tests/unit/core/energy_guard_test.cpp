#include "pliant/core/energy_guard.h"

#include <gtest/gtest.h>

#include "support/random.h"
#include "support/system_model.h"

namespace pliant::energy_guard_unit_test {
namespace {

TEST(EnergyGuard, TakesEnergyFromWhatTheSolverChangedAlone) {
  Random random(5);
  SystemModel model(random.positions(6, 1.0), Eigen::VectorXd::LinSpaced(6, 0.5, 2.0));
  Particles& p = model.particles();
  p.fix(3);
  constexpr double kDt = 0.01;
  model.system().external_forces = random.positions(6, 5.0);
  p.v_start = random.positions(6, 1.0);
  p.v_start.col(3).setZero();
  Eigen::Matrix3Xd forced = p.v_start;
  for (int i = 0; i < 6; ++i) {
    forced.col(i) += kDt * p.inverse_mass[i] * model.system().external_forces.col(i);
  }
  p.v = forced + random.positions(6, 2.0);
  p.v.col(3).setZero();
  const Eigen::Matrix3Xd before = p.v;
  const double kinetic = p.kinetic_energy();
  EnergyGuard::take(model.system(), 0.3, kDt);
  EXPECT_NEAR(p.kinetic_energy(), kinetic - 0.3, 1e-12);
  const double share = (p.v - forced)(0, 0) / (before - forced)(0, 0);
  EXPECT_GT(share, 0.0);
  EXPECT_LT((p.v - forced - share * (before - forced)).norm(), 1e-12);

  // More than there is: what is left is what forces would have given, or less.
  EnergyGuard::take(model.system(), 1e6, kDt);
  EXPECT_TRUE(p.v.allFinite());
  EXPECT_LE(p.kinetic_energy(), kinetic);
}

/// A ball of springs that its solver throws up in one step: iterations of a kind that gives energy.
class Thrower final : public Solver {
 public:
  std::string_view name() const override { return "thrower"; }
  bool is_dissipative() const override { return true; }
  void prepare(System&, double) override {}
  void step(System& system, double dt, StepReport&) override {
    Particles& p = system.particles;
    p.x_start.swap(p.x);
    p.v_start.swap(p.v);
    p.v = p.v_start + dt * system.external_forces * p.inverse_mass.asDiagonal();
    // The shorter the step, the less it throws; at all of it one metre per second.
    p.v.row(2).array() += dt > throws_above ? 1.0 : 0.0;
    p.x = p.x_start + dt * p.v;
  }
  double throws_above = 0.0;  // [s]
};

std::unique_ptr<World> thrown(double throws_above) {
  auto world = std::make_unique<World>(0.01);
  Body& body = world->add_body("ball", std::make_unique<SystemModel>(Positions::Zero(3, 1)));
  body.solver = std::make_unique<Thrower>();
  static_cast<Thrower&>(*body.solver).throws_above = throws_above;
  body.solver_dt = 0.01;
  world->set_initial_state();
  // Of the first step nothing is asked.
  const double after = static_cast<Thrower&>(*body.solver).throws_above;
  static_cast<Thrower&>(*body.solver).throws_above = 1.0;
  EXPECT_TRUE(world->step());
  static_cast<Thrower&>(*body.solver).throws_above = after;
  return world;
}

TEST(EnergyGuard, LetsStepsAloneThatGainNothing) {
  auto world = thrown(1.0);
  ASSERT_TRUE(world->step());
  EXPECT_TRUE(world->bodies().front().report.warnings.empty());
  EXPECT_EQ(world->bodies().front().particles().v.norm(), 0.0);
}

TEST(EnergyGuard, TakesAStepAgainInAsManyPartsAsItNeeds) {
  auto world = thrown(0.003);
  ASSERT_TRUE(world->step());
  const StepReport& report = world->bodies().front().report;
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings.front().find("4 parts"), std::string::npos) << report.warnings.front();
  EXPECT_EQ(report.warnings.front().find("taken from its motion"), std::string::npos);
  EXPECT_EQ(world->bodies().front().particles().v.norm(), 0.0);
  EXPECT_EQ(world->bodies().front().solver_dt, 0.01);
}

TEST(EnergyGuard, TakesTheRestFromTheMotion) {
  auto world = thrown(0.0);
  ASSERT_TRUE(world->step());
  const StepReport& report = world->bodies().front().report;
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings.front().find("taken from its motion"), std::string::npos);
  EXPECT_LT(world->bodies().front().particles().v.norm(), 1e-9);
}

}  // namespace
}  // namespace pliant::energy_guard_unit_test
