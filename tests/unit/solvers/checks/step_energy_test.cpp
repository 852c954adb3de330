// The energy that a step may end with.
#include "pliant/solvers/checks/step_energy.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/core/step/step_report.h"
#include "support/solvers/plain_constraint.h"
#include "support/solvers/system_model.h"

namespace pliant::step_energy_test {
namespace {

constexpr double kDt = 0.01, kMass = 2.0, kStiffness = 100.0;

/// A mass on a spring of 1 m that moves outwards from rest length.
struct Swing {
  explicit Swing(double speed) : model(mass_on_spring(kMass, kStiffness, 1.0)) {
    Particles& p = model->particles();
    p.x_start = p.x;
    p.v_start.setZero(3, 2);
    p.v_start(0, 1) = speed;
    system().external_forces.setZero(3, 2);
    energy.prepare(kDt);
  }
  ProjectiveSystem& system() { return static_cast<ProjectiveSystem&>(model->system()); }
  double length() { return model->particles().x(0, 1); }
  void go_to(double length) { model->particles().x(0, 1) = length; }

  std::unique_ptr<SystemModel> model;
  StepEnergy energy;
};

double energy_at(double length) {
  const double v = (length - 1.0) / kDt;
  return 0.5 * kMass * v * v + 0.5 * kStiffness * (length - 1.0) * (length - 1.0);
}

TEST(StepEnergy, AllowsAStepWithoutGain) {
  Swing swing(1.0);
  swing.go_to(1.0 + kDt);
  swing.energy.begin(swing.system());
  EXPECT_FALSE(swing.energy.gains(swing.system()));
}

TEST(StepEnergy, AStepThatGainsGoesLessFar) {
  Swing swing(1.0);
  swing.go_to(1.0 + 3.0 * kDt);
  swing.energy.begin(swing.system());
  ASSERT_TRUE(swing.energy.gains(swing.system()));
  swing.energy.hold_back(swing.system());
  // A tenth more than it began with.
  EXPECT_LE(energy_at(swing.length()), 1.1 * 0.5 * kMass);
  EXPECT_GT(swing.length(), 1.0);
}

// What other steps lost may come back, within a second.
TEST(StepEnergy, WhatWasLostMayBeGained) {
  Swing swing(1.0);
  swing.go_to(1.0);
  swing.energy.begin(swing.system());
  swing.energy.end(swing.system());
  const auto gains = [&] {
    swing.model->particles().v_start.setZero();
    swing.go_to(1.0 + 0.9 * kDt);
    swing.energy.begin(swing.system());
    return swing.energy.gains(swing.system());
  };
  EXPECT_FALSE(gains());
  for (int k = 0; k < 300; ++k) {
    swing.go_to(1.0);
    swing.energy.begin(swing.system());
    swing.energy.end(swing.system());
  }
  EXPECT_TRUE(gains());
}

// The same forces cannot be gained twice: what a step took of the reserve is gone.
TEST(StepEnergy, WhatWasGainedIsTakenFromTheReserve) {
  Swing swing(1.0);
  swing.go_to(1.0);
  swing.energy.begin(swing.system());
  swing.energy.end(swing.system());
  swing.model->particles().v_start.setZero();
  swing.go_to(1.0 + 0.9 * kDt);
  swing.energy.begin(swing.system());
  ASSERT_FALSE(swing.energy.gains(swing.system()));
  swing.energy.end(swing.system());
  swing.energy.begin(swing.system());
  EXPECT_TRUE(swing.energy.gains(swing.system()));
}

TEST(StepEnergy, AllowsVelocitiesOfTheSameEnergyOnly) {
  Swing swing(1.0);
  swing.go_to(1.0 + kDt);
  swing.energy.begin(swing.system());
  swing.energy.end(swing.system());
  Particles& p = swing.model->particles();
  p.v.setZero();
  p.v(0, 1) = 1.0;
  EXPECT_TRUE(swing.energy.allows(p));
  p.v(0, 1) = 1.2;
  EXPECT_FALSE(swing.energy.allows(p));
}

TEST(StepEnergy, GoesOnFromItsReserve) {
  Swing swing(1.0);
  swing.go_to(1.0);
  swing.energy.begin(swing.system());
  swing.energy.end(swing.system());
  StateArchive numbers;
  swing.energy.save(numbers);
  Swing other(0.0);
  other.energy.load(numbers);
  other.go_to(1.0 + 0.9 * kDt);
  other.energy.begin(other.system());
  EXPECT_FALSE(other.energy.gains(other.system()));
  // Without numbers it begins with none.
  numbers.clear();
  other.energy.load(numbers);
  other.energy.begin(other.system());
  EXPECT_TRUE(other.energy.gains(other.system()));
}

/// Keeps the mass above a plane and pulls it along x.
class ToldConstraint final : public TellingConstraint {
 public:
  double gap = 1.0;      // [m]
  double force = 0.0;    // from 1 m on [N]
  bool is_late = false;  // found where iterations came
  void add_point_constraints(const Positions&, PointConstraints& constraints) override {
    PointConstraint& point = constraints.append();
    point.normal = Eigen::Vector3d::UnitY();
    point.gap = gap;
    point.is_late = is_late;
    constraints.add(1, 1.0);
  }
  double work(const Positions& x) const override { return force * (x(0, 1) - 1.0); }
};

TEST(StepEnergy, KnowsWhatAStepIsAllowedUnlessAnObstacleComesToBeThere) {
  for (const double gap : {0.1, 0.0, -0.1}) {
    Swing swing(1.0);
    ToldConstraint constraint;
    constraint.gap = gap;
    swing.system().constraints = {&constraint};
    swing.go_to(1.0 + kDt);
    swing.energy.begin(swing.system());
    EXPECT_EQ(swing.energy.is_known(), gap >= 0.0) << gap;
  }
}

// Iterations that went through a wall find its far side: the step is allowed no energy to bring its
// beginning there.
TEST(StepEnergy, WhatIsFoundLateDoesNotPartWhatTheStepBeganWith) {
  for (const bool is_late : {false, true}) {
    Swing swing(1.0);
    ToldConstraint constraint;
    constraint.gap = -0.1;
    constraint.is_late = is_late;
    swing.system().constraints = {&constraint};
    swing.go_to(1.0 + 3.0 * kDt);
    swing.energy.begin(swing.system());
    EXPECT_EQ(swing.energy.gains(swing.system()), is_late);
    EXPECT_EQ(swing.energy.is_known(), is_late);
  }
}

TEST(StepEnergy, WhatAForceCouldHaveGivenAndNothingTookIsNotLost) {
  // It began with 1 J and ends at half the speed, while 20 N on a path of 5 mm gave 0.1 J more.
  for (const double force : {0.0, 20.0}) {
    Swing swing(1.0);
    ToldConstraint constraint;
    constraint.force = force;
    swing.system().constraints = {&constraint};
    swing.go_to(1.0 + 0.5 * kDt);
    swing.energy.begin(swing.system());
    swing.energy.end(swing.system());
    EXPECT_NEAR(swing.energy.gained(), energy_at(1.0 + 0.5 * kDt) - 0.5 * kMass, 1e-12) << force;
  }
}

}  // namespace
}  // namespace pliant::step_energy_test
