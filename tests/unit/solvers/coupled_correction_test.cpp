// The correction that respects what constraints hold, against its dense saddle-point system.
#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/math/dense_factors.h"
#include "pliant/math/symmetric_eigen.h"
#include "pliant/solvers/constrained/constrained_correction.h"
#include "pliant/solvers/constrained/equality_constrained_correction.h"
#include "support/random.h"
#include "support/solvers/matrices.h"
#include "support/solvers/plain_constraint.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

constexpr double kStep = 0.005;
constexpr double kLeft = 1e-5;  // of the conditions' residual, by its iterations

struct Case {
  Case() : system(spring_net(30, 2, 500.0, 1.0)) {
    for (int i : {2, 11}) system.particles.fix(i);
    rows.clear();
    r = Random(6).positions(30, 1.0);
    for (int i : {2, 11}) r.col(i).setZero();
  }
  /// A condition on particle i along `gradient`.
  void hold(int i, const Eigen::Vector3d& gradient, double target = 0.0, double compliance = 0.0) {
    rows.begin_row(target, compliance);
    rows.add(i, gradient);
  }
  /// A condition on many particles, as air's.
  void hold_many(double target, double compliance) {
    Random random(8);
    rows.begin_row(target, compliance);
    for (int i = 0; i < 30; i += 2) rows.add(i, random.vector(0.01));
  }

  ProjectiveSystem system;
  ConstraintRows rows;
  Forces r;
};

/// The conditions J d = c + C mu over the coordinates of free particles, each scaled to a gradient
/// of length 1, which is no other condition.
struct DenseRows {
  DenseRows(const ConstraintRows& rows, const Particles& particles)
      : j(Eigen::MatrixXd::Zero(rows.size(), 3 * particles.size())),
        c(rows.size()),
        compliance(rows.size()) {
    for (int row = 0; row < rows.size(); ++row) {
      for (const auto* entry = rows.begin(row); entry != rows.end(row); ++entry) {
        if (particles.is_fixed(entry->particle)) continue;
        j.block<1, 3>(row, 3 * entry->particle) += entry->gradient.transpose();
      }
      const double length = j.row(row).norm();
      const double scale = length > 0.0 ? 1.0 / length : 0.0;
      j.row(row) *= scale;
      c[row] = scale * rows.target(row);
      compliance[row] = scale * scale * rows.compliance(row);
    }
  }
  Eigen::MatrixXd j;
  Eigen::VectorXd c, compliance;
};

/// d of [P J^T; J -C] [d; mu] = [r; c].
Eigen::VectorXd dense_solution(const Forces& r, const Eigen::MatrixXd& p, const DenseRows& rows) {
  const Eigen::Index n = p.rows(), m = rows.j.rows();
  Eigen::MatrixXd saddle(n + m, n + m);
  saddle << p, rows.j.transpose(), rows.j, -Eigen::MatrixXd(rows.compliance.asDiagonal());
  Eigen::VectorXd right(n + m);
  right << Eigen::Map<const Eigen::VectorXd>(r.data(), n), rows.c;
  // Rows twice make it singular; mu is then one of many, d is not.
  const SymmetricEigen eigen = symmetric_eigen(saddle);
  const Eigen::VectorXd size = eigen.values.cwiseAbs();
  const Eigen::VectorXd along = eigen.vectors.transpose() * right;
  return (eigen.vectors *
          (size.array() > 1e-14 * size.maxCoeff()).select(along.cwiseQuotient(eigen.values), 0.0))
      .head(n);
}

/// How far d may be off in the norm of P, where the conditions keep kLeft of their residual:
/// |Δd|² = ρᵀ S⁺ ρ <= |ρ|² / λ_min(S), S = J P⁻¹ Jᵀ + C.
double bound(const Forces& r, const Eigen::MatrixXd& p, const DenseRows& rows) {
  if (rows.j.rows() == 0) return 0.0;
  const DenseCholesky factor(p);
  Eigen::MatrixXd s = rows.j * factor.solve(Eigen::MatrixXd(rows.j.transpose()));
  s.diagonal() += rows.compliance;
  const Eigen::VectorXd start =
      rows.j *
          factor.solve(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(r.data(), r.size()))) -
      rows.c;
  const Eigen::VectorXd values = symmetric_eigenvalues(s);
  for (double value : values) {
    if (value > 1e-10 * values.tail(1)[0]) return kLeft * start.norm() / std::sqrt(value);
  }
  return 0.0;
}

/// Solves, compares with the dense solution and returns the iterations.
int expect_solution(Case& given) {
  const Particles& particles = given.system.particles;
  const Eigen::MatrixXd a = dense_matrix(given.system, kStep);
  const Eigen::MatrixXd p = over_coordinates(a);
  const DenseCholesky factor(a);
  Eigen::Matrix3Xd d = given.r;
  EqualityConstrainedCorrection correction;
  correction.set_accuracy(kLeft);
  correction.solve(
      given.rows, particles, [&](Eigen::Matrix3Xd& v) { v = (v * a).eval(); },
      [&](Eigen::Matrix3Xd& v) { v = factor.solve(Eigen::MatrixXd(v.transpose())).transpose(); },
      d);
  const DenseRows rows(given.rows, particles);
  const Eigen::VectorXd expected = dense_solution(given.r, p, rows);
  const Eigen::VectorXd error = Eigen::Map<Eigen::VectorXd>(d.data(), d.size()) - expected;
  const double round_off = 1e-12 * std::sqrt(expected.dot(p * expected));
  EXPECT_LE(std::sqrt(error.dot(p * error)), bound(given.r, p, rows) + round_off);
  return correction.iterations();
}

TEST(EqualityConstrainedCorrection, WithoutConditionsItIsThePlainOne) {
  Case given;
  EXPECT_EQ(expect_solution(given), 0);
}

TEST(EqualityConstrainedCorrection, HoldsContacts) {
  Case given;
  for (int i : {0, 3, 4, 5, 20, 29})
    given.hold(i, Random(5 + static_cast<std::uint64_t>(i)).vector(1));
  // As many iterations as there are conditions solve it exactly.
  EXPECT_LE(expect_solution(given), 6);
}

TEST(EqualityConstrainedCorrection, HoldsAllDirectionsOfAParticle) {
  Case given;
  for (int axis = 0; axis < 3; ++axis) given.hold(5, Eigen::Vector3d::Unit(axis));
  expect_solution(given);
}

TEST(EqualityConstrainedCorrection, ReachesTargets) {
  Case given;
  given.hold(3, {0, 0, 1}, 0.01);
  given.hold(4, {0, 1, 0}, -0.02);
  given.hold(6, {1, 0, 0}, 0.0);
  EXPECT_FALSE(given.rows.are_met());
  expect_solution(given);
}

TEST(EqualityConstrainedCorrection, YieldsAsMuchAsTheCompliance) {
  // From rigid to so soft that it holds nothing.
  for (const double compliance : {0.0, 1e-9, 1e-5, 1.0, 1e6}) {
    Case given;
    given.hold_many(0.0, compliance);
    EXPECT_LE(expect_solution(given), 3) << compliance;
  }
}

TEST(EqualityConstrainedCorrection, SoftAndRigidTogether) {
  Case given;
  given.hold_many(1e-3, 1e-5);
  for (int i = 0; i < 30; i += 3) given.hold(i, {0, 0, 1}, i == 9 ? 0.005 : 0.0);
  EXPECT_LE(expect_solution(given), 11);
}

TEST(EqualityConstrainedCorrection, AConditionTwiceIsTheConditionOnce) {
  Case once, twice;
  for (int i : {0, 3, 4}) once.hold(i, {0.1, 0.2, 1});
  for (int i : {0, 3, 4, 3}) twice.hold(i, {0.1, 0.2, 1});
  expect_solution(once);
  expect_solution(twice);
}

TEST(EqualityConstrainedCorrection, FixedParticlesAreHeldAlready) {
  Case given;
  given.hold(2, {0, 0, 1});  // fixed: nothing that could move
  given.hold(5, {0, 1, 0});
  given.rows.begin_row(0.0, 0.0);  // one end fixed
  given.rows.add(11, {0, 0, 1});
  given.rows.add(12, {0, 0, -1});
  expect_solution(given);
}

TEST(EqualityConstrainedCorrection, AllConditionsOnFixedParticlesChangeNothing) {
  Case given;
  given.hold(2, {0, 0, 1});
  given.hold(11, {1, 0, 0});
  EXPECT_EQ(expect_solution(given), 0);
}

TEST(EqualityConstrainedCorrection, NoForceNoCorrection) {
  Case given;
  given.r.setZero();
  given.hold(3, {0, 0, 1});
  EXPECT_EQ(expect_solution(given), 0);
}

TEST(EqualityConstrainedCorrection, GradientsOfAnyLengthAreAlike) {
  // The unit of a gradient is the condition's own affair.
  for (const double scale : {1e-6, 1.0, 1e6}) {
    Case given;
    given.hold(3, {0, 0, scale});
    given.hold(4, {0, 1, 0});
    given.hold(5, {0, 0.5, 0.5 * scale});
    EXPECT_LE(expect_solution(given), 4) << scale;
  }
}

/// Tells what a test gave it.
class GivenConstraint final : public TellingConstraint {
 public:
  PointConstraints given;
  void add_point_constraints(const Positions&, PointConstraints& constraints) override {
    constraints = given;
  }
};

TEST(ConstrainedCorrection, ATieIsMissedByWhatItsMultiplierIsOff) {
  // w = 0.5 m/N times the gradient's 4 is 2, of which a quarter and the tie's own 0.5 make C = 1:
  // the answer to a gap of 3 is 10 - 3, or 8.5 where that is the lowest.
  for (const double lowest : {-100.0, 8.5}) {
    ProjectiveSystem system;
    system.particles = Particles(Positions::Zero(3, 1), Eigen::VectorXd::Ones(1));
    GivenConstraint constraint;
    TyingConstraint& tie = constraint.given.append_tie();
    tie.gap = 3.0;
    tie.compliance = 0.5;
    tie.force = 10.0;
    tie.lowest = lowest;
    tie.highest = 100.0;
    constraint.given.add_gradient(0, {0.0, 0.0, 2.0});
    system.constraints = {&constraint};
    ConstrainedCorrection correction;
    correction.set_compliance(0.25);
    const double off = 10.0 - std::max(7.0, lowest);
    Eigen::VectorXd violations;
    correction.find_squared_violations(system, Eigen::VectorXd::Constant(1, 0.5), violations);
    ASSERT_EQ(violations.size(), 1);
    EXPECT_NEAR(violations[0], 2.0 * off * off, 1e-12);
  }
}

TEST(ConstrainedCorrection, ContactsOfRigidBodiesMayBeStiffer) {
  ConstrainedCorrection correction;
  PointConstraint soft, rigid;
  rigid.is_rigid = true;
  const double before = correction.compliance(rigid, 2.0), other = correction.compliance(soft, 2.0);
  EXPECT_LT(before, other);
  correction.stiffen_rigid(0.1);
  EXPECT_NEAR(correction.compliance(rigid, 2.0), 0.1 * before, 1e-15);
  EXPECT_EQ(correction.compliance(soft, 2.0), other);
}

TEST(ConstrainedCorrection, FindsATieWhoseForceIsBoundOnEitherSideOfIt) {
  // d = 3 + λ, λ = -(5 + d)/C between -10 and 10, with P = 1 N/m and C = 0.01 m/N. From d = 0 the
  // lowest force leads to d = -7, from there the highest to 13, and from there the lowest to -7
  // again, for ever without a search between.
  ProjectiveSystem system;
  system.particles = Particles(Positions::Zero(3, 1), Eigen::VectorXd::Ones(1));
  GivenConstraint constraint;
  TyingConstraint& tie = constraint.given.append_tie();
  tie.gap = 5.0;
  tie.lowest = -10.0;
  tie.highest = 10.0;
  constraint.given.add_gradient(0, {1.0, 0.0, 0.0});
  system.constraints = {&constraint};
  ConstrainedCorrection correction;
  correction.set_compliance(0.01);
  correction.set_accuracy(1e-9);
  correction.collect(system);
  Eigen::Matrix3Xd d = Eigen::Vector3d(3.0, 0.0, 0.0);
  const auto inverse = [](const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left) {
    for (const auto& row : rows.ties()) v(0, 0) /= 1.0 + 1.0 / row.compliance;
    left.setZero(3, 1);
    return true;
  };
  const Eigen::VectorXd mobility = Eigen::VectorXd::Ones(1);
  ASSERT_TRUE(correction.find(12, mobility, inverse, d));
  EXPECT_TRUE(correction.is_found());
  const double expected = (3.0 - 500.0) / 101.0;
  EXPECT_NEAR(d(0, 0), expected, 1e-8);
  EXPECT_NEAR(correction.forces()(0, 0), expected - 3.0, 1e-8);
}

/// Particles in a row along x, neighbours tied by springs of 1 N/m, each held by `ground` in all
/// directions [N/m], on a plane with friction that presses each by 1 N.
struct RowOnAPlane {
  static constexpr int kCount = 20;

  explicit RowOnAPlane(double ground) : matrix(Eigen::MatrixXd::Zero(3 * kCount, 3 * kCount)) {
    system.particles = Particles(Positions::Zero(3, kCount), Eigen::VectorXd::Ones(kCount));
    for (int i = 0; i < kCount; ++i) {
      matrix.diagonal().segment<3>(3 * i).array() += ground;
      PointConstraint& point = constraint.given.append();
      point.normal = Eigen::Vector3d::UnitZ();
      point.friction = 0.5;
      point.normal_force = 1.0;
      constraint.given.add(i, 1.0);
      if (i == 0) continue;
      for (int k = 0; k < 3; ++k) {
        const int a = 3 * i + k, b = a - 3;
        matrix(a, a) += 1.0;
        matrix(b, b) += 1.0;
        matrix(a, b) -= 1.0;
        matrix(b, a) -= 1.0;
      }
    }
    system.constraints = {&constraint};
    correction.set_compliance(1.0);
    correction.set_accuracy(1e-6);
    correction.collect(system);
    forces = Eigen::Matrix3Xd::Zero(3, kCount);
    forces.row(2).setConstant(-1.0);
  }
  /// v <- (P + Jᵀ C⁻¹ J)⁻¹ v.
  bool solve(const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left) const {
    Eigen::MatrixXd all = matrix;
    for (int r = 0; r < rows.size(); ++r) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(3 * kCount);
      for (const auto* e = rows.begin(r); e != rows.end(r); ++e) {
        row.segment<3>(3 * e->particle) += e->weight * rows.direction(r);
      }
      all += row * row.transpose() / rows.compliance(r);
    }
    v.reshaped() = all.ldlt().solve(Eigen::VectorXd(v.reshaped()));
    left.setZero(3, kCount);
    return true;
  }
  bool find(int rounds, const Eigen::VectorXd& mobility, Eigen::Matrix3Xd& d) {
    d = forces;
    return correction.find(
        rounds, mobility,
        [this](const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left) {
          return solve(rows, v, left);
        },
        d);
  }

  Eigen::MatrixXd matrix;
  ProjectiveSystem system;
  GivenConstraint constraint;
  ConstrainedCorrection correction;
  Eigen::Matrix3Xd forces;
};

TEST(ConstrainedCorrection, CautiousRoundsFindWhichPointsSlide) {
  // Pulled at one end, and aside in the middle, with the friction of five and a half of twenty
  // points, of whose normal forces nothing is known yet: some slide, the others stick. C is small.
  // By tangents, those that slide go far off, and 60 rounds do not come to an end.
  const Eigen::VectorXd mobility = Eigen::VectorXd::Constant(RowOnAPlane::kCount, 1e-2);
  for (const bool is_cautious : {false, true}) {
    RowOnAPlane row(1e-3);
    row.forces(0, 0) = 2.75;
    row.forces(1, 7) = 0.825;
    row.correction.set_cautious(is_cautious);
    for (PointConstraint& point : row.correction.constraints().all) point.normal_force = 0.0;
    Eigen::Matrix3Xd d;
    ASSERT_TRUE(row.find(is_cautious ? 30 : 60, mobility, d));
    EXPECT_EQ(row.correction.is_found(), is_cautious);
    if (!is_cautious) continue;
    const Forces& forces = row.correction.forces();
    int sliding = 0;
    for (int i = 0; i < RowOnAPlane::kCount; ++i) {
      const double friction = forces.col(i).head<2>().norm(), most = 0.5 * forces(2, i);
      EXPECT_LE(friction, most * (1.0 + 1e-5)) << i;
      if (friction > most * (1.0 - 1e-5)) ++sliding;
    }
    EXPECT_GE(sliding, 3);
    EXPECT_LE(sliding, 17);
    // All is in balance: P d = r + forces.
    const Eigen::VectorXd left =
        row.matrix * d.reshaped() - Eigen::VectorXd((row.forces + forces).reshaped());
    EXPECT_LT(left.norm(), 1e-9);
  }
}

}  // namespace
}  // namespace pliant
