#include "pliant/elements/clusters/oriented_cluster_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/solvers/matrices.h"

namespace pliant {
namespace {

constexpr double kMass = 0.01, kRadius = 0.05, kSpacing = 0.1, kStiffness = 1e4;
constexpr int kCount = 11;

/// A straight rod along x of particles in overlapping threes: shape matching alone cannot tell
/// whether it is twisted.
class Rod : public testing::Test {
 protected:
  static Positions rest() {
    Positions x = Positions::Zero(3, kCount);
    for (int i = 0; i < kCount; ++i) x(0, i) = kSpacing * i;
    return x;
  }
  static OrientedClusterSet make() {
    std::vector<Cluster> clusters;
    for (int i = 0; i + 2 < kCount; ++i) clusters.push_back({{i, i + 1, i + 2}, kStiffness});
    const Eigen::Matrix3d moment = ellipsoid_moment(kMass, Eigen::Vector3d::Constant(kRadius));
    return OrientedClusterSet(rest(), Eigen::VectorXd::Constant(kCount, kMass),
                              std::vector<Eigen::Matrix3d>(kCount, moment), clusters);
  }
  OrientedClusterSet set_ = make();
};

Eigen::Quaterniond about(const Eigen::Vector3d& axis, double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

TEST_F(Rod, TurnedWithItsParticlesItIsAtRest) {
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::Matrix3d turn = random.rotation();
    for (int i = 0; i < kCount; ++i) {
      set_.set_orientation(i, Eigen::Quaterniond(turn), Eigen::Vector3d::Zero());
    }
    const Positions x = (turn * rest()).colwise() + random.vector(10.0);
    EXPECT_NEAR(set_.energy(x), 0.0, 1e-24);
    EXPECT_LE(forces_of(set_, x).norm(), 1e-10);
  }
}

TEST_F(Rod, EnergyIsBlindToRigidMotionOfAllOfIt) {
  Random random(2);
  const Positions x = rest() + random.positions(kCount, 0.02);
  std::vector<Eigen::Quaterniond> turns;
  for (int i = 0; i < kCount; ++i) turns.push_back(about(random.vector(1.0).normalized(), 0.4));
  const auto set_all = [&](const Eigen::Quaterniond& motion) {
    for (int i = 0; i < kCount; ++i) {
      set_.set_orientation(i, motion * turns[static_cast<std::size_t>(i)], {0, 0, 0});
    }
  };
  set_all(Eigen::Quaterniond::Identity());
  const double energy = set_.energy(x);
  const Forces f = forces_of(set_, x);
  const Eigen::Quaterniond motion(random.rotation());
  set_all(motion);
  EXPECT_NEAR(set_.energy(motion.toRotationMatrix() * x), energy, 1e-12 * energy);
  EXPECT_LE((forces_of(set_, motion.toRotationMatrix() * x) - motion.toRotationMatrix() * f).norm(),
            1e-12 * f.norm());
}

TEST_F(Rod, ATurnedParticleBendsTheRod) {
  // Turned about z, the middle particle turns its clusters, and their ends move along y.
  set_.set_orientation(5, about(Eigen::Vector3d::UnitZ(), 0.5), {0, 0, 0});
  const Forces f = forces_of(set_, rest());
  EXPECT_GT(f(1, 7), 0.1);
  EXPECT_LT(f(1, 3), -0.1);
  EXPECT_LE(f.rowwise().sum().norm(), 1e-12);
  EXPECT_GT(set_.energy(rest()), 0.0);
}

TEST_F(Rod, ResistsTorsion) {
  // One end is turned about the rod; positions stay, the twist spreads, and its energy falls.
  for (int i = 0; i < 3; ++i)
    set_.set_orientation(i, about(Eigen::Vector3d::UnitX(), 1.0), {0, 0, 0});
  double energy = set_.energy(rest());
  EXPECT_GT(energy, 0.0);
  for (int step = 0; step < 400; ++step) {
    set_.advance_orientations(rest(), 0.01);
    EXPECT_LE(set_.energy(rest()), energy * (1.0 + 1e-9) + 1e-15) << step;
    energy = set_.energy(rest());
  }
  const Eigen::AngleAxisd last(set_.orientation(kCount - 1));
  EXPECT_NEAR(std::abs(last.axis()[0]), 1.0, 1e-9);
  EXPECT_GT(last.angle(), 0.2);
}

TEST_F(Rod, AFreeParticleKeepsTurning) {
  const Positions rest = Positions::Zero(3, 1);
  OrientedClusterSet set(rest, Eigen::VectorXd::Ones(1), {ellipsoid_moment(1.0, {0.1, 0.2, 0.3})},
                         {});
  const Eigen::Vector3d velocity(0.3, -0.2, 0.5);
  set.set_orientation(0, Eigen::Quaterniond::Identity(), velocity);
  for (int step = 0; step < 100; ++step) set.advance_orientations(rest, 0.01);
  const Eigen::Quaterniond expected = about(velocity.normalized(), velocity.norm());
  EXPECT_LE(set.orientation(0).angularDistance(expected), 1e-12);
  EXPECT_LE((set.angular_velocity(0) - velocity).norm(), 1e-10);
}

TEST_F(Rod, OneParticleIsACluster) {
  const Positions rest = Positions::Constant(3, 1, 2.0);
  OrientedClusterSet set(rest, Eigen::VectorXd::Ones(1), {ellipsoid_moment(1.0, {0.1, 0.2, 0.3})},
                         {{{0}, 100.0}});
  set.set_orientation(0, about(Eigen::Vector3d::UnitY(), 2.0), {0, 0, 1.0});
  EXPECT_NEAR(set.energy(rest), 0.0, 1e-28);
  EXPECT_TRUE(forces_of(set, rest).isZero(1e-14));
}

TEST_F(Rod, CollapsedToAPointItStillKnowsItsTurn) {
  // A moment of positions alone vanishes there; the particles' own keep the rank.
  const Eigen::Quaterniond turn = about(Eigen::Vector3d::UnitZ(), 2.5);
  for (int i = 0; i < kCount; ++i) set_.set_orientation(i, turn, {0, 0, 0});
  Positions x = Positions::Zero(3, kCount);
  for (int step = 0; step < 500; ++step) {
    set_.reset_multipliers();
    for (int sweep = 0; sweep < 20; ++sweep) {
      set_.relax(Eigen::VectorXd::Constant(kCount, 1.0 / kMass), 1.0, x);
    }
  }
  const Positions expected = turn.toRotationMatrix() * rest();
  EXPECT_LE(((x.colwise() - x.col(0)) - expected).norm(), 1e-6);
}

TEST_F(Rod, BlendsOfTurnsAgreeUpToTheCubeOfTheAngle) {
  Random random(11);
  for (const double angle : {0.02, 0.2}) {
    std::vector<Eigen::Quaterniond> turns;
    for (int i = 0; i < kCount; ++i) turns.push_back(about(random.vector(1.0).normalized(), angle));
    std::vector<std::vector<Eigen::Quaterniond>> ends;
    for (const TurnBlend blend :
         {TurnBlend::kMoments, TurnBlend::kLinear, TurnBlend::kExponential}) {
      OrientedClusterSet set = make();
      set.set_blend(blend);
      for (int i = 0; i < kCount; ++i) {
        set.set_orientation(i, turns[static_cast<std::size_t>(i)], {0, 0, 0});
      }
      set.advance_orientations(rest(), 0.01);
      ends.emplace_back();
      for (int i = 0; i < kCount; ++i) ends.back().push_back(set.orientation(i));
    }
    double moved = 0.0;
    for (std::size_t i = 0; i < kCount; ++i) {
      EXPECT_LT(ends[0][i].angularDistance(ends[1][i]), angle * angle * angle);
      EXPECT_LT(ends[0][i].angularDistance(ends[2][i]), angle * angle * angle);
      moved = std::max(moved, ends[0][i].angularDistance(turns[i]));
    }
    EXPECT_GT(moved, 0.1 * angle) << "they were blended at all";
  }
}

TEST_F(Rod, ResetForgetsTurns) {
  set_.set_orientation(4, about(Eigen::Vector3d::UnitZ(), 1.0), {1, 2, 3});
  set_.reset();
  EXPECT_EQ(set_.energy(rest()), make().energy(rest()));
  EXPECT_EQ(set_.orientation(4).coeffs(), Eigen::Quaterniond::Identity().coeffs());
  EXPECT_TRUE(set_.angular_velocity(4).isZero(0.0));
}

TEST_F(Rod, SavedItGoesOnBitForBit) {
  Random random(5);
  const Positions x = rest() + random.positions(kCount, 0.02);
  for (int i = 0; i < kCount; ++i) {
    set_.set_orientation(i, about(random.vector(1.0).normalized(), 0.4), random.vector(3.0));
  }
  set_.advance_orientations(x, 0.01);
  StateArchive numbers;
  set_.save(numbers);
  OrientedClusterSet twin = make();
  twin.load(numbers);
  // Crushed to a point, where the rotations kept decide.
  for (const Positions& state : {x, Positions(Positions::Zero(3, kCount))}) {
    EXPECT_EQ(forces_of(twin, state), forces_of(set_, state));
    set_.advance_orientations(state, 0.01);
    twin.advance_orientations(state, 0.01);
    for (int i = 0; i < kCount; ++i) {
      EXPECT_EQ(twin.orientation(i).coeffs(), set_.orientation(i).coeffs());
      EXPECT_EQ(twin.angular_velocity(i), set_.angular_velocity(i));
    }
  }
}

TEST_F(Rod, RefusesBadMoments) {
  const Eigen::VectorXd masses = Eigen::VectorXd::Ones(2);
  const Positions rest = Positions::Identity(3, 2);
  const Eigen::Matrix3d good = ellipsoid_moment(1.0, {0.1, 0.1, 0.1});
  const auto refuse = [&](const Eigen::Matrix3d& bad) {
    expect_refusal(
        [&] {
          OrientedClusterSet(rest, masses, {good, bad}, {{{0, 1}, 1.0}});
        },
        {"oriented_cluster", "particle 1", "ellipsoid_moment"});
  };
  refuse(Eigen::Matrix3d::Zero());
  refuse(ellipsoid_moment(-1.0, {0.1, 0.1, 0.1}));
  refuse(ellipsoid_moment(1.0, {0.1, 0.0, 0.1}));
  refuse(ellipsoid_moment(std::nan(""), {0.1, 0.1, 0.1}));
  Eigen::Matrix3d skew = good;
  skew(0, 1) = 1.0;
  refuse(skew);
  expect_refusal([&] { OrientedClusterSet(rest, masses, {good}, {}); },
                 {"1 moments", "2 particles"});
}

}  // namespace
}  // namespace pliant
