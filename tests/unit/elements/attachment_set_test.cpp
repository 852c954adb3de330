#include "pliant/elements/attachment_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_refusal.h"
#include "support/solvers/matrices.h"

namespace pliant {
namespace {

const Positions kAtOrigin = Positions::Zero(3, 4);

TEST(AttachmentSet, PullsTowardsItsPoint) {
  AttachmentSet set(4);
  set.add(2, {1.0, 2.0, 3.0}, 10.0);
  EXPECT_EQ(set.size(), 1);
  EXPECT_DOUBLE_EQ(set.energy(kAtOrigin), 0.5 * 10.0 * 14.0);
  const Forces f = forces_of(set, kAtOrigin);
  EXPECT_EQ(f.col(2), Eigen::Vector3d(10.0, 20.0, 30.0));
  EXPECT_TRUE(f.leftCols(2).isZero(0.0));
}

TEST(AttachmentSet, FollowsItsFrame) {
  AttachmentSet set(4);
  set.add(0, {1.0, 0.0, 0.0}, 1.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(5.0, 0.0, 0.0));
  pose.rotate(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  set.set_frame(pose);
  EXPECT_LE((set.target(set.attachments().front()) - Eigen::Vector3d(5.0, 1.0, 0.0)).norm(), 1e-15);
  EXPECT_LE((forces_of(set, kAtOrigin).col(0) - Eigen::Vector3d(5.0, 1.0, 0.0)).norm(), 1e-15);
}

TEST(AttachmentSet, TargetsMoveOneByOne) {
  AttachmentSet set(4);
  const int first = set.add(0, {1.0, 0.0, 0.0}, 1.0);
  const int second = set.add(1, {1.0, 0.0, 0.0}, 1.0);
  set.set_target(second, {0.0, 0.0, 7.0});
  const Forces f = forces_of(set, kAtOrigin);
  EXPECT_EQ(f.col(0), Eigen::Vector3d(1.0, 0.0, 0.0));
  EXPECT_EQ(f.col(1), Eigen::Vector3d(0.0, 0.0, 7.0));
  EXPECT_NE(first, second);
}

TEST(AttachmentSet, RemovedLeavesNoTrace) {
  AttachmentSet set(4);
  const int first = set.add(0, {1.0, 0.0, 0.0}, 1.0);
  const int second = set.add(1, {2.0, 0.0, 0.0}, 2.0);
  const int third = set.add(2, {3.0, 0.0, 0.0}, 3.0);
  Positions x = kAtOrigin;
  set.relax(Eigen::VectorXd::Ones(4), 0.1, x);
  set.remove(second);
  EXPECT_TRUE(forces_of(set, kAtOrigin).col(1).isZero(0.0));
  EXPECT_TRUE(system_of(set, 4).row(1).isZero(0.0));
  x = kAtOrigin;
  set.reset_multipliers();
  set.relax(Eigen::VectorXd::Ones(4), 0.1, x);
  EXPECT_TRUE(x.col(1).isZero(0.0));
  EXPECT_GT(x(0, 2), 0.0);
  EXPECT_EQ(set.attachments().back().handle, third);
  // Handles are not used again, particles are.
  const int again = set.add(1, {2.0, 0.0, 0.0}, 2.0);
  EXPECT_GT(again, third);
  expect_refusal([&] { set.remove(second); }, {"no attachment 1", "has 3"});
  set.remove(first);
  set.clear();
  EXPECT_EQ(set.size(), 0);
  EXPECT_EQ(set.energy(kAtOrigin), 0.0);
}

TEST(AttachmentSet, SavedAttachmentsComeBack) {
  AttachmentSet set(4), twin(4);
  set.remove(set.add(0, {1.0, 0.0, 0.0}, 1.0));
  const int handle = set.add(2, {1.0, 2.0, 3.0}, 5.0);
  set.set_frame(Eigen::Isometry3d(Eigen::Translation3d(0.0, 4.0, 0.0)));
  StateArchive saved;
  set.write(saved);
  twin.add(1, {9.0, 9.0, 9.0}, 9.0);
  twin.read(saved);
  EXPECT_EQ(forces_of(twin, kAtOrigin), forces_of(set, kAtOrigin));
  EXPECT_EQ(twin.add(0, {0.0, 0.0, 0.0}, 1.0), handle + 1);
}

TEST(AttachmentSet, RefusesASavedStateThatNobodyCouldHaveAttached) {
  constexpr std::size_t kPose = 16;
  AttachmentSet set(4);
  set.add(2, {1.0, 2.0, 3.0}, 5.0);
  set.add(1, {1.0, 2.0, 3.0}, 5.0);
  StateArchive saved;
  set.write(saved);
  std::vector<double> values;
  while (saved.left() > 0) values.push_back(saved.read());
  const double kNaN = std::nan("");
  const std::vector<std::pair<std::size_t, double>> wrongs = {{0, kNaN},     // the frame
                                                              {kPose, 0.0},  // handles until now
                                                              {kPose + 1, 3.0},    // attachments
                                                              {kPose + 2, -1.0},   // a handle
                                                              {kPose + 3, 4.0},    // a particle
                                                              {kPose + 3, 1.0},    // held twice
                                                              {kPose + 5, kNaN},   // a point
                                                              {kPose + 7, -5.0}};  // a stiffness
  for (const auto& [place, wrong] : wrongs) {
    StateArchive damaged;
    for (std::size_t k = 0; k < values.size(); ++k) damaged.write(k == place ? wrong : values[k]);
    EXPECT_THROW(AttachmentSet(4).read(damaged), InputError) << place << ": " << wrong;
  }
}

TEST(AttachmentSet, OneSweepIsImplicitEuler) {
  AttachmentSet set(4);
  set.add(3, {1.0, 0.0, 0.0}, 200.0);
  Positions x = kAtOrigin;
  set.relax(Eigen::VectorXd::Constant(4, 0.5), 0.1, x);
  // m x / h² = k (a - x)
  EXPECT_DOUBLE_EQ(x(0, 3), 200.0 / (200.0 + 2.0 / 0.01));
  const Positions once = x;
  set.relax(Eigen::VectorXd::Constant(4, 0.5), 0.1, x);
  EXPECT_LE((x - once).norm(), 1e-15);
}

TEST(AttachmentSet, WrenchIsTheReaction) {
  AttachmentSet set(4);
  set.add(0, {0.0, 1.0, 0.0}, 10.0);
  set.add(1, {0.0, -1.0, 0.0}, 10.0);
  Eigen::Isometry3d pose(Eigen::Translation3d(100.0, 0.0, 0.0));
  set.set_frame(pose);
  Positions x = kAtOrigin;
  x.col(0) << 100.5, 1.0, 0.0;
  x.col(1) << 99.5, -1.0, 0.0;
  Eigen::Matrix<double, 6, 1> expected;
  expected << 0, 0, 0, 0, 0, -10.0;
  EXPECT_LE((set.wrench(x) - expected).norm(), 1e-12);
  // A force has its torque about the frame's origin, not about the world's.
  x.col(0) << 100.5, 1.5, 0.0;
  x.col(1) << 100.0, -1.0, 0.0;
  expected << 5.0, 5.0, 0, 0, 0, -5.0;
  EXPECT_LE((set.wrench(x) - expected).norm(), 1e-12);
}

TEST(AttachmentSet, RefusesBadInput) {
  const double inf = std::numeric_limits<double>::infinity();
  AttachmentSet set(4);
  const int handle = set.add(1, {0, 0, 0}, 1.0);
  expect_refusal([&] { set.add(4, {0, 0, 0}, 1.0); }, {"particle 4", "[0, 3]"});
  expect_refusal([&] { set.add(-1, {0, 0, 0}, 1.0); }, {"particle -1"});
  expect_refusal([&] { set.add(1, {0, 0, 0}, 1.0); }, {"particle 1", "attachment 0 already"});
  for (const double bad : {0.0, -1.0, inf, std::nan("")}) {
    expect_refusal([&] { set.add(2, {0, 0, 0}, bad); }, {"stiffness", "N/m", "positive"});
  }
  for (const double bad : {inf, std::nan("")}) {
    expect_refusal([&] { set.add(2, {0, bad, 0}, 1.0); }, {"point", "not finite"});
    expect_refusal([&] { set.set_target(handle, {0, bad, 0}); }, {"point", "not finite"});
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation()[0] = bad;
    expect_refusal([&] { set.set_frame(pose); }, {"pose", "not finite"});
  }
  expect_refusal([&] { set.set_target(77, {0, 0, 0}); }, {"no attachment 77"});
  EXPECT_EQ(set.size(), 1);
}

}  // namespace
}  // namespace pliant
