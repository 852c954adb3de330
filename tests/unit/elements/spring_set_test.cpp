#include "pliant/elements/cloth/spring_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

Positions pair_at(double distance) {
  Positions x = Positions::Zero(3, 2);
  x(0, 1) = distance;
  return x;
}

Forces forces(const SpringSet& set, const Positions& x) {
  Forces f = Forces::Zero(3, x.cols());
  set.add_forces(x, f);
  return f;
}

TEST(SpringSet, EnergyAndForceOfOneSpring) {
  const SpringSet set("stretch", {{0, 1, 2.0, 10.0}}, 2);
  EXPECT_EQ(set.name(), "stretch");
  EXPECT_EQ(set.size(), 1);
  EXPECT_DOUBLE_EQ(set.energy(pair_at(2.5)), 0.5 * 10.0 * 0.25);
  EXPECT_TRUE(forces(set, pair_at(2.5)).col(0).isApprox(Eigen::Vector3d(5, 0, 0), 1e-15));
  EXPECT_TRUE(forces(set, pair_at(1.5)).col(0).isApprox(Eigen::Vector3d(-5, 0, 0), 1e-15));
}

TEST(SpringSet, StrainsPerSpringAndVertex) {
  const SpringSet set("stretch", {{0, 1, 2.0, 10.0}, {1, 2, 1.0, 10.0}}, 3);
  Positions x = Positions::Zero(3, 3);
  x.row(0) << 0, 3, 4;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(3), count = Eigen::VectorXd::Zero(3);
  set.add_strains(x, sum, count);
  EXPECT_EQ(sum, Eigen::Vector3d(0.5, 0.5, 0.0));
  EXPECT_EQ(count, Eigen::Vector3d(1, 2, 1));
  EXPECT_DOUBLE_EQ(set.strains(x).sum(), 0.5);
}

TEST(SpringSet, CoincidentEndsStayFinite) {
  SpringSet set("stretch", {{0, 1, 1.0, 10.0}}, 2);
  Positions x = Positions::Zero(3, 2);
  EXPECT_DOUBLE_EQ(set.energy(x), 5.0);
  EXPECT_TRUE(forces(set, x).allFinite());
  set.reset_multipliers();
  set.relax(Eigen::Vector2d(1, 1), 0.01, x);
  EXPECT_TRUE(x.allFinite());
}

TEST(SpringSet, TinyAndHugeDistancesStayFinite) {
  SpringSet set("stretch", {{0, 1, 1.0, 10.0}}, 2);
  for (const double distance : {1e-300, 1e-160, 1e-100, 1e-15, 1e15, 1e100}) {
    Positions x = pair_at(distance);
    EXPECT_TRUE(forces(set, x).allFinite()) << distance;
    set.reset_multipliers();
    set.relax(Eigen::Vector2d(1, 1), 0.01, x);
    EXPECT_TRUE(x.allFinite()) << distance;
  }
}

TEST(SpringSet, RelaxLeavesTwoFixedEnds) {
  SpringSet set("stretch", {{0, 1, 1.0, 10.0}}, 2);
  Positions x = pair_at(3.0);
  set.reset_multipliers();
  set.relax(Eigen::Vector2d(0, 0), 0.01, x);
  EXPECT_EQ(x, pair_at(3.0));
}

TEST(SpringSet, RefusesBadSprings) {
  const double inf = std::numeric_limits<double>::infinity();
  const auto refuse = [](const Spring& spring, const std::string& part) {
    expect_refusal(
        [&] {
          SpringSet("shear", {{0, 1, 1, 1}, spring}, 3);
        },
        {"shear spring 1", part});
  };
  for (const double bad : {0.0, -1.0, inf, std::nan("")}) {
    refuse({0, 1, bad, 1.0}, "positive rest length");
    refuse({0, 1, 1.0, bad}, "positive stiffness");
  }
  refuse({0, 3, 1, 1}, "particles 0 and 3 of 3");
  refuse({-1, 1, 1, 1}, "particles -1 and 1 of 3");
  refuse({2, 2, 1, 1}, "different particles");
}

}  // namespace
}  // namespace pliant
