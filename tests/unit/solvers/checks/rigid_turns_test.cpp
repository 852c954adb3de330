// Vectors of a rigid body's particles turn with it about their mean, and those of others stay.
#include "pliant/solvers/checks/rigid_turns.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/worlds/body_pairs.h"

namespace pliant::rigid_turns_test {
namespace {

const Eigen::Vector3d kAxis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
constexpr double kAngle = 1.2;  // [rad]

/// A box, or a cloth, that turned and moved in its last step.
class Turned {
 public:
  explicit Turned(const std::string& body)
      : world_(world_of(scene_text({"  - {name: body, " + body + "}\n"}, "  gravity: {}\n"))),
        system_(*world_->bodies().front().model->system().as_projective()) {
    Particles& p = system_.particles;
    p.x_start = p.x;
    for (int i = 0; i < p.size(); ++i) {
      p.x.col(i) = turn(1.0) * p.x_start.col(i) + Eigen::Vector3d(0.1, 0.2, -0.3);
    }
  }

  Eigen::Matrix3Xd applied(double steps, Eigen::Matrix3Xd d) const {
    RigidTurns turns;
    turns.prepare(system_);
    turns.find(system_.particles, steps);
    turns.apply(d);
    return d;
  }
  static Eigen::Matrix3d turn(double steps) {
    return Eigen::AngleAxisd(steps * kAngle, kAxis).toRotationMatrix();
  }
  const Particles& particles() const { return system_.particles; }

 private:
  std::unique_ptr<World> world_;
  ProjectiveSystem& system_;
};

const char* const kBox = "model: rigid, geometry: {box: {size: [0.1, 0.06, 0.03]}}";

TEST(RigidTurns, AMotionOfTheBodyStaysOne) {
  const Turned box(kBox);
  const Particles& p = box.particles();
  const Eigen::Vector3d shift(0.01, -0.02, 0.03), spin = 0.05 * kAxis;
  Eigen::Matrix3Xd before(3, p.size()), after(3, p.size());
  Eigen::Vector3d start = Eigen::Vector3d::Zero(), end = Eigen::Vector3d::Zero();
  for (int i = 0; i < p.size(); ++i) {
    start += p.mass[i] / p.mass.sum() * p.x_start.col(i);
    end += p.mass[i] / p.mass.sum() * p.x.col(i);
  }
  for (int i = 0; i < p.size(); ++i) {
    before.col(i) = shift + spin.cross(Eigen::Vector3d(p.x_start.col(i) - start));
    after.col(i) = shift + spin.cross(Eigen::Vector3d(p.x.col(i) - end));
  }
  EXPECT_GT((before - after).norm(), 1e-3);
  EXPECT_NEAR((box.applied(1.0, before) - after).norm(), 0.0, 1e-12);
}

TEST(RigidTurns, SeveralStepsTurnAsManyTimes) {
  const Turned box(kBox);
  Eigen::Matrix3Xd d = box.particles().x;
  const Eigen::Vector3d middle = d * box.particles().mass / box.particles().mass.sum();
  const Eigen::Matrix3Xd turned = box.applied(2.5, d);
  for (int i = 0; i < d.cols(); ++i) {
    const Eigen::Vector3d expected = middle + Turned::turn(2.5) * (d.col(i) - middle);
    EXPECT_NEAR((turned.col(i) - expected).norm(), 0.0, 1e-12) << i;
  }
}

TEST(RigidTurns, WhatBendsStays) {
  const Turned cloth("model: cloth, geometry: {grid: {size: [0.1, 0.1], vertices: [3, 3]}}");
  const Eigen::Matrix3Xd d = cloth.particles().x;
  EXPECT_EQ(cloth.applied(1.0, d), d);
}

}  // namespace
}  // namespace pliant::rigid_turns_test
