#include "pliant/solvers/iterations/step_objective.h"

#include <gtest/gtest.h>

#include "pliant/elements/cloth/spring_set.h"
#include "support/epsilon.h"
#include "support/random.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

class StepObjectiveOf : public testing::TestWithParam<StepProblem> {
 protected:
  StepObjectiveOf() : system(GetParam().make()), y(system.particles.x) {
    objective.prepare(system, GetParam().dt);
    objective.begin_step(system);
    // Somewhere else than at the prediction.
    Random random(12);
    for (int i = 0; i < y.cols(); ++i) {
      const Eigen::Vector3d off = random.vector(0.01);
      if (!system.particles.is_fixed(i)) system.particles.x.col(i) += off;
    }
  }
  double value_at(Positions x) {
    system.particles.x.swap(x);
    const double value = objective.value(system);
    system.particles.x.swap(x);
    return value;
  }
  Forces forces() {
    Forces r;
    StepReport report;
    objective.forces(system, r, report);
    return r;
  }

  ProjectiveSystem system;
  Positions y;
  StepObjective objective;
};
INSTANTIATE_TEST_SUITE_P(Problems, StepObjectiveOf, testing::ValuesIn(step_problems()),
                         problem_name);

TEST_P(StepObjectiveOf, ForcesAreMinusItsGradient) {
  const Forces r = forces();
  const double value = objective.value(system);
  Random random(3);
  for (int trial = 0; trial < 5; ++trial) {
    Positions d = random.positions(system.particles.size(), 1.0);
    for (int i = 0; i < d.cols(); ++i) {
      if (system.particles.is_fixed(i)) d.col(i).setZero();
    }
    d.normalize();
    const double h = 1e-6;
    const Positions up = system.particles.x + h * d, down = system.particles.x - h * d;
    const double slope = (value_at(up) - value_at(down)) / (2.0 * h);
    // Round-off of the value; the third derivative is a stiffness over the shortest length, 1 mm.
    const double bound = 10 * kEpsilon * value / h + objective.diagonal().maxCoeff() / 1e-3 * h * h;
    EXPECT_NEAR(slope, -r.cwiseProduct(d).sum(), bound);
  }
}

TEST_P(StepObjectiveOf, IsInertiaPlusElasticEnergy) {
  double expected = system.elastic_energy();
  const Particles& p = system.particles;
  const double h = GetParam().dt;
  for (int i = 0; i < p.size(); ++i) {
    if (!p.is_fixed(i)) expected += p.mass[i] * (p.x.col(i) - y.col(i)).squaredNorm() / (2 * h * h);
  }
  EXPECT_NEAR(objective.value(system), expected, 1e-13 * expected);
}

TEST_P(StepObjectiveOf, FixedParticlesAreInBalance) {
  const Forces r = forces();
  for (int i = 0; i < r.cols(); ++i) {
    if (system.particles.is_fixed(i)) {
      EXPECT_TRUE(r.col(i).isZero(0.0));
    }
  }
}

TEST_P(StepObjectiveOf, DiagonalIsThatOfTheProjectiveMatrix) {
  const Eigen::MatrixXd a = dense_matrix(system, GetParam().dt);
  for (int i = 0; i < a.rows(); ++i) {
    if (system.particles.is_fixed(i)) continue;
    EXPECT_NEAR(objective.diagonal()[i], a(i, i), 50 * kEpsilon * a(i, i)) << i;
  }
}

/// Holds with the forces that it is told.
class FakeConstraint final : public Constraint {
 public:
  explicit FakeConstraint(const Forces& forces) : forces(forces) {}
  std::string_view name() const override { return "fake"; }
  void begin_step(const Particles&, double) override {}
  void reset_multipliers() override {}
  void relax(const Eigen::VectorXd&, Positions&) override {}
  void add_forces(Forces& f) const override { f += forces; }
  void add_rows(const Positions&, ConstraintRows&) override {}
  Forces forces;
};

/// Two free particles of 1 kg and a fixed one without elements; the step is 1 s.
class Residual : public testing::Test {
 protected:
  Residual() : system(system_at(Positions::Ones(3, 3), 1.0)) {
    system.particles.fix(2);
    objective.prepare(system, 1.0);
    objective.begin_step(system);
    r = Forces::Zero(3, 3);
    r(0, 0) = 3.0;
    r(1, 1) = 4.0;
  }
  double relative(double share, int iteration) {
    return objective.relative_residual(system, share * r, iteration);
  }
  ProjectiveSystem system;
  StepObjective objective;
  Forces r;
};

TEST_F(Residual, NormIsThatOfTheInverseDiagonal) {
  // D = m/h² = 1.
  EXPECT_DOUBLE_EQ(objective.norm(r), 5.0);
  objective.prepare(system, 0.5);
  EXPECT_DOUBLE_EQ(objective.norm(r), 2.5);
}

TEST_F(Residual, IsRelativeToTheLargestOfTheFirstTwo) {
  EXPECT_DOUBLE_EQ(relative(1.0, 1), 1.0);
  EXPECT_DOUBLE_EQ(relative(2.0, 2), 1.0);
  EXPECT_DOUBLE_EQ(relative(0.5, 3), 0.25);
  // It may well grow; that must be seen.
  EXPECT_DOUBLE_EQ(relative(8.0, 4), 4.0);
  EXPECT_DOUBLE_EQ(relative(1.0, 5), 0.5);
}

TEST_F(Residual, TheNextStepHasItsOwnScale) {
  EXPECT_DOUBLE_EQ(relative(1.0, 1), 1.0);
  objective.begin_step(system);
  EXPECT_DOUBLE_EQ(relative(1e-3, 1), 1.0);
}

TEST_F(Residual, RoundOffIsNone) {
  // Moving particles at distance 1 by their last bit makes forces of some 1e-16 N.
  EXPECT_EQ(relative(1e-17, 1), 0.0);
  EXPECT_TRUE(objective.is_round_off(1e-16));
  EXPECT_FALSE(objective.is_round_off(1e-13));
  EXPECT_EQ(relative(0.0, 2), 0.0);
}

TEST_F(Residual, CountsWhatConstraintsBalance) {
  FakeConstraint constraint(-r);
  system.constraints.push_back(&constraint);
  EXPECT_EQ(relative(1.0, 1), 0.0);
  EXPECT_DOUBLE_EQ(relative(0.5, 3), 0.5);
}

TEST_F(Residual, ARestingBodysScaleIsItsContactForce) {
  FakeConstraint constraint(Forces::Zero(3, 3));
  system.constraints.push_back(&constraint);
  EXPECT_DOUBLE_EQ(relative(1e-3, 1), 1.0);
  constraint.forces = -r;
  EXPECT_NEAR(relative(0.999, 2), 0.001, 1e-15);
}

/// Two pairs of particles, of 1 kg and of 1 g each, that springs hold together.
TEST(ResidualOfBodies, IsThatOfTheBodyWhereItIsLargest) {
  Positions x = Positions::Zero(3, 4);
  x.row(0) << 0.0, 1.0, 2.0, 3.0;
  ProjectiveSystem system = system_at(x, 1.0);
  for (const int light : {2, 3}) {
    system.particles.mass[light] = 1e-3;
    system.particles.inverse_mass[light] = 1e3;
  }
  const std::vector<Spring> springs = {{0, 1, 1.0, 1e-12}, {2, 3, 1.0, 1e-12}};
  system.elements.push_back(std::make_unique<SpringSet>("springs", springs, 4));
  StepObjective objective;
  objective.prepare(system, 1.0);
  objective.begin_step(system);
  Forces r = Forces::Zero(3, 4);
  r(2, 0) = 10.0;
  r(2, 2) = 0.01;
  EXPECT_DOUBLE_EQ(objective.relative_residual(system, r, 1), 1.0);
  // The heavy one is balanced, the light one not at all: of all forces that is a thousandth.
  r(2, 0) = 0.0;
  EXPECT_NEAR(objective.relative_residual(system, r, 3), 1.0, 1e-9);
  EXPECT_NEAR(objective.last_residual(), 0.01 / std::sqrt(1e-3), 1e-9);
  r(2, 2) = 1e-4;
  EXPECT_NEAR(objective.relative_residual(system, r, 3), 0.01, 1e-9);
  // What hardly anything pushes is compared with a hundredth of its share of all forces.
  objective.begin_step(system);
  r(2, 0) = 10.0;
  r(2, 2) = 1e-7;
  EXPECT_DOUBLE_EQ(objective.relative_residual(system, r, 1), 1.0);
  r(2, 0) = 0.0;
  EXPECT_NEAR(objective.relative_residual(system, r, 3), 1e-3, 1e-6);
}

TEST_F(Residual, WhatPushesAFixedParticleIsBalanced) {
  FakeConstraint constraint(Forces::Zero(3, 3));
  constraint.forces(2, 2) = 100.0;
  system.constraints.push_back(&constraint);
  EXPECT_DOUBLE_EQ(relative(1.0, 1), 1.0);
}

}  // namespace
}  // namespace pliant
