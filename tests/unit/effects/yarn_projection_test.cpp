#include "pliant/effects/strain_limit/yarn_projection.h"

#include <gtest/gtest.h>

#include "pliant/effects/strain_limit/yarn_constraints.h"
#include "pliant/effects/strain_limit/yarn_limits.h"
#include "pliant/elements/cloth/spring_set.h"
#include "support/random.h"

namespace pliant {
namespace {

constexpr double kMax = 1.01;

/// A row of particles, a metre apart, and the yarns between them.
struct Chain {
  Positions x;
  Yarns yarns;
  Eigen::VectorXd mobility;

  explicit Chain(int count) : x(Positions::Zero(3, count)), mobility(count) {
    mobility.setOnes();
    yarns.begins = {0};
    for (int i = 0; i < count; ++i) x(0, i) = i;
    for (const int odd : {0, 1}) {
      for (int i = odd; i + 1 < count; i += 2) {
        yarns.all.push_back({{i, i + 1, i}, {-1.0, 1.0, 0.0}, 1.0});
      }
      yarns.begins.push_back(static_cast<int>(yarns.all.size()));
    }
  }
  double largest_stretch() const {
    double largest = 0.0;
    for (const Yarn& yarn : yarns.all) largest = std::max(largest, yarn.along(x).norm());
    return largest;
  }
};

int project(Chain& chain, YarnProjection& projection, double tolerance = 1e-3) {
  return projection.project(chain.yarns, kMax, chain.mobility, 200, tolerance, {}, chain.x);
}

TEST(YarnProjection, LeavesAloneWhatIsWithinItsLimit) {
  Chain chain(30);
  chain.x.row(0) *= 0.9;
  const Positions before = chain.x;
  YarnProjection projection;
  EXPECT_EQ(project(chain, projection), 1);
  EXPECT_EQ(chain.x, before);
}

// A hundred yarns between two posts, with half of all mass on the middle, each pulled down by
// half a yarn. Sweeps pass a force on by one yarn at a time.
TEST(YarnProjection, HoldsALongChainBetweenTwoPosts) {
  Chain chain(101);
  chain.mobility[0] = chain.mobility[100] = 0.0;
  chain.mobility[50] = 0.01;
  for (int i = 1; i < 100; ++i) chain.x(1, i) = -0.14 * std::min(i, 100 - i) - 0.5;
  const Positions before = chain.x;
  YarnProjection projection;
  EXPECT_LT(project(chain, projection), 100);
  EXPECT_LE(chain.largest_stretch(), kMax + 1e-3);
  EXPECT_EQ(chain.x.col(0), before.col(0));
  EXPECT_EQ(chain.x.col(100), before.col(100));
  // As deep as the yarns let it hang.
  const double deepest = std::sqrt(kMax * kMax - 1.0) * 50.0;
  EXPECT_NEAR(chain.x(1, 50), -deepest, 0.05 * deepest);
}

TEST(YarnProjection, KeepsMomentumAndTurnsWithWhatItMoves) {
  Chain chain(40);
  Random random(3);
  chain.x += random.positions(40, 0.5);
  for (int i = 0; i < 40; ++i) chain.mobility[i] = 1.0 + 0.1 * (i % 7);
  Chain turned = chain;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  turned.x = turn * chain.x;
  const Positions before = chain.x;
  YarnProjection one, other;
  EXPECT_GT(project(chain, one), 1);
  project(turned, other);
  EXPECT_LE((turned.x - turn * chain.x).norm(), 1e-10);
  const Eigen::Vector3d gained = (chain.x - before) * chain.mobility.cwiseInverse();
  EXPECT_LE(gained.norm(), 1e-12 * (chain.x - before).norm());
}

TEST(YarnProjection, FollowsMassesThatChange) {
  Chain chain(30);
  chain.x.row(0) *= 1.3;
  YarnProjection projection, fresh;
  Chain before = chain;
  project(before, projection);
  chain.mobility.head(10).setConstant(0.2);
  Chain same = chain;
  project(chain, projection);
  project(same, fresh);
  EXPECT_EQ(chain.x, same.x);
  EXPECT_LE(chain.largest_stretch(), kMax + 1e-3);
}

/// Area between a chain and the x axis, which has to come back to what it was, by a force on both
/// sides or one that only pulls down.
class KeptArea final : public LinearConstraintProvider {
 public:
  KeptArea(const Positions& x, bool may_push) : wanted_(area(x)), may_push_(may_push) {}
  static double area(const Positions& x) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i + 1 < x.cols(); ++i) {
      sum += 0.5 * (x(1, i) + x(1, i + 1)) * (x(0, i + 1) - x(0, i));
    }
    return sum;
  }
  double missed(const Positions& x) const { return area(x) - wanted_; }

  double missed_linear_constraints(const Positions& x) override {
    const double own = missed(x);
    return (may_push_ ? std::abs(own) : own) / kTolerance;
  }
  void add_linear_constraints(const Positions& x, LinearConstraints& conditions) override {
    LinearConstraint& condition = conditions.append();
    condition.owner = this;
    condition.number = 7;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Eigen::Index a = std::max<Eigen::Index>(0, i - 1), b = std::min(x.cols() - 1, i + 1);
      condition.entries.push_back(
          {static_cast<int>(i), {0.5 * (x(1, a) - x(1, b)), 0.5 * (x(0, b) - x(0, a)), 0.0}});
    }
    condition.target = -missed(x);
    condition.least = -1e300;
    condition.most = may_push_ ? 1e300 : 0.0;
  }
  void set_change(int number, double change) override {
    EXPECT_EQ(number, 7);
    change_ = change;
  }
  void take_changes() override { multiplier += change_; }

  static constexpr double kTolerance = 1e-3;  // [m²]
  double multiplier = 0.0;

 private:
  double wanted_;
  bool may_push_;
  double change_ = 0.0;
};

/// An arch of somewhat loose yarns on two feet, whose top was pulled up by half of one.
struct PulledArch : Chain {
  Positions before;
  PulledArch() : Chain(31) {
    for (int i = 0; i <= 30; ++i) {
      const double t = M_PI * i / 30.0;
      x.col(i) << -10.0 * std::cos(t), 10.0 * std::sin(t), 0.0;
    }
    for (Yarn& yarn : yarns.all) yarn.length = yarn.along(x).norm();
    mobility[0] = mobility[15] = mobility[30] = 0.0;
    before = x;
    x(1, 15) += 0.5;
  }
};

TEST(YarnProjection, KeepsAnAreaBesideTheLimits) {
  PulledArch arch;
  KeptArea kept(arch.before, true);
  std::vector<LinearConstraintProvider*> keepers = {&kept};
  YarnProjection projection;
  EXPECT_LT(projection.project(arch.yarns, kMax, arch.mobility, 200, 1e-3, keepers, arch.x), 200);
  for (const Yarn& yarn : arch.yarns.all) {
    EXPECT_LE(yarn.along(arch.x).norm(), (kMax + 2e-3) * yarn.length);
  }
  EXPECT_LE(std::abs(kept.missed(arch.x)), KeptArea::kTolerance);
  EXPECT_NE(kept.multiplier, 0.0);
  PulledArch alone;
  projection.project(alone.yarns, kMax, alone.mobility, 200, 1e-3, {}, alone.x);
  EXPECT_GT(std::abs(kept.missed(alone.x)), 10 * KeptArea::kTolerance) << "the test says nothing";
}

TEST(YarnProjection, LeavesAMultiplierWithinItsBounds) {
  PulledArch arch, alone;
  Positions larger = arch.before;
  larger.row(1) *= 1.2;
  KeptArea kept(larger, false);  // there is less than it may have: it would have to push
  std::vector<LinearConstraintProvider*> keepers = {&kept};
  YarnProjection projection, other;
  projection.project(arch.yarns, kMax, arch.mobility, 200, 1e-3, keepers, arch.x);
  other.project(alone.yarns, kMax, alone.mobility, 200, 1e-3, {}, alone.x);
  EXPECT_EQ(kept.multiplier, 0.0);
  EXPECT_EQ(arch.x, alone.x);
}

TEST(YarnProjection, DoesNothingWhereNothingMoves) {
  Chain chain(5);
  chain.x.row(0) *= 2.0;
  chain.mobility.setZero();
  const Positions before = chain.x;
  YarnProjection projection;
  EXPECT_EQ(project(chain, projection), 0);
  EXPECT_EQ(chain.x, before);
}

// J d = c - C lambda, with a unit of the multiplier moving each mass by its gradient over it.
TEST(YarnConstraints, GiveWayByTheirCompliance) {
  const Eigen::Vector3d along(1.0, 0.0, 0.0), across(0.0, -2.0, 0.0);
  constexpr double kScale = 4.0;
  const Eigen::Vector2d masses(4.0, 8.0);  // over the squared step [N/m]
  SparseRows matrix(2, 2);
  matrix.insert(0, 0) = masses[0] / kScale;
  matrix.insert(1, 1) = masses[1] / kScale;
  CholeskySolver factor;
  factor.factor(matrix);
  for (const double compliance : {0.0, 0.25, 10.0}) {
    LinearConstraints conditions;
    LinearConstraint& condition = conditions.append();
    condition.entries = {{0, along}, {1, across}};
    condition.target = 0.3;
    condition.compliance = compliance;
    condition.least = -1e9;
    condition.most = 1e9;
    Eigen::Matrix3Xd moved = Eigen::Matrix3Xd::Zero(3, 2);
    YarnConstraints constraints;
    constraints.take(conditions, masses / kScale, kScale, moved, factor);
    constraints.apply(moved);
    const double multiplier = 0.3 / (1.0 / 4.0 + 4.0 / 8.0 + compliance);
    EXPECT_NEAR(constraints.change(0), multiplier, 1e-14) << compliance;
    EXPECT_LE((moved.col(0) - multiplier / 4.0 * along).norm(), 1e-14) << compliance;
    EXPECT_LE((moved.col(1) - multiplier / 8.0 * across).norm(), 1e-14) << compliance;
  }
}

/// The limits of one yarn of half a metre, which may become 0.55 m long.
struct OneYarn {
  OneYarn() : x(Positions::Zero(3, 2)) {
    std::vector<std::unique_ptr<ElementSet>> elements;
    elements.push_back(
        std::make_unique<SpringSet>("stretch", std::vector<Spring>{{0, 1, 0.5, 1.0}}, 2));
    limits = std::make_unique<YarnLimits>(elements, 2, 1.1);
    limits->begin_step(Particles(x, Eigen::VectorXd::Ones(2)), {});
    limits->reset_multipliers();
  }
  Positions x;
  std::unique_ptr<YarnLimits> limits;
};

TEST(YarnLimits, ASweepTakesWhatAYarnIsTooLongFromBothItsEnds) {
  OneYarn yarn;
  yarn.x(0, 1) = 0.8;
  // The far end moves three times as much for a force.
  yarn.limits->relax(Eigen::Vector2d(1.0, 3.0), yarn.x);
  EXPECT_NEAR(yarn.x(0, 0), 0.0625, 1e-15);
  EXPECT_NEAR(yarn.x(0, 1), 0.6125, 1e-15);
  EXPECT_EQ(yarn.limits->active(), 1);
  Forces forces = Forces::Zero(3, 2);
  yarn.limits->add_forces(forces);
  EXPECT_NEAR(forces(0, 0), 0.0625, 1e-15);
  EXPECT_NEAR(forces(0, 1), -0.0625, 1e-15);
}

TEST(YarnLimits, ARowAsksForWhatIsMissingToTheLimit) {
  OneYarn yarn;
  yarn.x(0, 1) = 0.8;
  yarn.limits->relax(Eigen::Vector2d::Ones(), yarn.x);
  for (const double length : {0.5, 0.55, 0.7}) {
    yarn.x.col(0).setZero();
    yarn.x.col(1) << 0.0, length, 0.0;
    ConstraintRows rows;
    yarn.limits->add_rows(yarn.x, rows);
    ASSERT_EQ(rows.size(), 1);
    EXPECT_NEAR(rows.target(0), 0.55 - length, 1e-15);
    ASSERT_EQ(rows.end(0) - rows.begin(0), 2);
    for (const auto* entry = rows.begin(0); entry != rows.end(0); ++entry) {
      const double sign = entry->particle == 0 ? -1.0 : 1.0;
      EXPECT_LE((entry->gradient - sign * Eigen::Vector3d::UnitY()).norm(), 1e-15);
    }
  }
}

}  // namespace
}  // namespace pliant
