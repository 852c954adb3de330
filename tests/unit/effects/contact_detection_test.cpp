#include "pliant/effects/contact/contact_detection.h"

#include <gtest/gtest.h>

#include "pliant/effects/contact/particle_contact_detection.h"
#include "support/meshes/shapes.h"
#include "support/random.h"
#include "support/worlds/particle_bodies.h"
#include "support/worlds/worlds.h"

namespace pliant::contact_detection_test {
namespace {

constexpr double kOffset = 0.001, kMargin = 0.0005, kDt = 0.01;
// What single-precision clear balls and the sweep's root may leave, far below the offset.
constexpr double kTolerance = 1e-8;

/// One obstacle and one particle that moves from `from` to `to`.
struct Case {
  explicit Case(const std::string& shape) {
    obstacles.resize(1);
    obstacles[0].shape = primitive(shape);
  }
  std::vector<Contact> find(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    Particles p(from, Eigen::VectorXd::Ones(1));
    p.x = to;
    std::vector<Contact> contacts;
    ContactDetection(obstacles, kOffset, kMargin).find(p, kDt, contacts);
    return contacts;
  }
  std::vector<Obstacle> obstacles;
};

class EveryPrimitive : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Shapes, EveryPrimitive, every_primitive());

/// The point `gap` above the highest point of `shape`.
Eigen::Vector3d above(const Shape& shape, double gap) {
  Eigen::Vector3d p(0, 0, 1);
  for (int k = 0; k < 100; ++k) p.z() -= shape.distance(p);
  return p + Eigen::Vector3d(0, 0, gap);
}

TEST_P(EveryPrimitive, RestingIsAContactAtTheOffset) {
  Case c(GetParam());
  const Eigen::Vector3d p = above(*c.obstacles[0].shape, kOffset);
  const auto contacts = c.find(p, p);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].point, 0);
  EXPECT_EQ(contacts[0].obstacle, 0);
  EXPECT_TRUE(contacts[0].normal.isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_NEAR(contacts[0].plane, p.z(), kTolerance);
  EXPECT_TRUE(contacts[0].surface_motion.isZero(1e-15));
}

TEST_P(EveryPrimitive, TheMarginDecidesWhatIsNear) {
  Case c(GetParam());
  const Shape& shape = *c.obstacles[0].shape;
  const Eigen::Vector3d near = above(shape, kOffset + 0.9 * kMargin);
  const Eigen::Vector3d far = above(shape, kOffset + 1.1 * kMargin);
  EXPECT_EQ(c.find(near, near).size(), 1u);
  EXPECT_TRUE(c.find(far, far).empty());
}

TEST_P(EveryPrimitive, AFastParticleIsStoppedAtTheOffset) {
  Case c(GetParam());
  const Eigen::Vector3d from = above(*c.obstacles[0].shape, 0.5);
  const Eigen::Vector3d to = from - Eigen::Vector3d(0, 0, 10.0);
  const auto contacts = c.find(from, to);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_TRUE(contacts[0].normal.isApprox(Eigen::Vector3d::UnitZ(), 1e-6));
  EXPECT_NEAR(contacts[0].plane, above(*c.obstacles[0].shape, kOffset).z(), kTolerance);
}

TEST_P(EveryPrimitive, AFastObstacleTakesTheParticleAlong) {
  Case c(GetParam());
  const Eigen::Vector3d p = above(*c.obstacles[0].shape, 0.5);
  c.obstacles[0].pose_end = at(0, 0, 10.0);
  const auto contacts = c.find(p, p);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].plane, above(*c.obstacles[0].shape, kOffset).z() + 10.0, 1e-7);
  EXPECT_TRUE(contacts[0].surface_motion.isApprox(Eigen::Vector3d(0, 0, 10), 1e-12));
}

TEST_P(EveryPrimitive, AStartInsideIsPushedOutSlowly) {
  Case c(GetParam());
  for (const double depth : {0.0005, 0.002, 0.02, 0.04}) {
    const Eigen::Vector3d p = above(*c.obstacles[0].shape, -depth);
    const auto contacts = c.find(p, p);
    ASSERT_EQ(contacts.size(), 1u) << depth;
    const double push = contacts[0].plane - contacts[0].normal.dot(p);
    EXPECT_GT(push, 0.0);
    // 1 m/s at the most.
    EXPECT_LE(push, 1.0 * kDt + 1e-12);
    EXPECT_NEAR(push, std::min(depth + kOffset, kDt), kTolerance);
  }
}

TEST_P(EveryPrimitive, MovingAwayFromInsideIsLeftAlone) {
  Case c(GetParam());
  const Eigen::Vector3d from = above(*c.obstacles[0].shape, -0.01);
  const Eigen::Vector3d to = above(*c.obstacles[0].shape, 0.1);
  for (const Contact& contact : c.find(from, to)) {
    EXPECT_GE(contact.normal.dot(to), contact.plane - kTolerance);
  }
}

TEST_P(EveryPrimitive, FixedParticlesHaveNoContacts) {
  Case c(GetParam());
  Particles p(above(*c.obstacles[0].shape, 0.0), Eigen::VectorXd::Ones(1));
  p.fix(0);
  std::vector<Contact> contacts;
  ContactDetection(c.obstacles, kOffset, kMargin).find(p, kDt, contacts);
  EXPECT_TRUE(contacts.empty());
}

TEST(ContactDetection, ARotatingBoxSweepsWhatIsInItsWay) {
  Case c("box");
  c.obstacles[0].pose_end.linear() =
      Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  // Just off the long side, near its end: the side turns by 8 mm towards it.
  const Eigen::Vector3d p(0.08, 0.0765, 0.0);
  const auto contacts = c.find(p, p);
  ASSERT_EQ(contacts.size(), 1u);
  const Eigen::Vector3d moved =
      p + contacts[0].normal * (contacts[0].plane - contacts[0].normal.dot(p));
  const Eigen::Vector3d local = c.obstacles[0].pose_end.inverse() * moved;
  EXPECT_NEAR(c.obstacles[0].shape->distance(local), kOffset, kTolerance);
  EXPECT_GT(contacts[0].surface_motion.norm(), 0.005);
}

/// A point in the middle of four particles that move as one, as that of a solid does.
struct CarriedCase : Case {
  using Case::Case;
  static Eigen::Matrix3Xd around(const Eigen::Vector3d& middle) {
    Eigen::Matrix3Xd corners(3, 4);
    corners << 1, -1, 0, 0, 0, 0, 1, -1, 1, 1, -1, -1;
    return (0.01 * corners).colwise() + middle;
  }
  /// As the step predicts it, or as iterations brought it from there.
  std::vector<Contact> find(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                            const Eigen::Vector3d& velocity, bool is_prediction) {
    Eigen::Matrix4Xi carriers(4, 1);
    carriers << 0, 1, 2, 3;
    const EmbeddedPoints points(carriers, Eigen::Matrix4Xd::Constant(4, 1, 0.25));
    Particles p(around(from), Eigen::VectorXd::Ones(4));
    p.x_start = p.x;
    p.x = around(to);
    p.v_start.setZero(3, 4);
    p.v_start.colwise() += velocity;
    ContactDetection detection(obstacles, kOffset, kMargin, ContactPoints(&points));
    std::vector<Contact> contacts;
    detection.find(p, kDt, contacts);
    if (is_prediction) return contacts;
    contacts.clear();
    detection.find_again(p, kDt, contacts);
    return contacts;
  }
};

// A point that is held beside a face, above the face's lower edge, is predicted to fall past it.
TEST(ContactDetection, WhatIsHeldIsKeptFromTheFaceBesideWhichItIs) {
  const double fall = 9.81 * kDt * kDt;
  CarriedCase c("box");
  const auto* box = as<Box>(*c.obstacles[0].shape);
  ASSERT_NE(box, nullptr);
  const Eigen::Vector3d half = 0.5 * box->size();
  const Eigen::Vector3d from(half.x() + kOffset + 1e-9, 0.0, -half.z() + 0.5 * fall);
  const Eigen::Vector3d to = from - Eigen::Vector3d(0, 0, fall), none = Eigen::Vector3d::Zero();
  const auto contacts = c.find(from, to, none, true);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_TRUE(contacts[0].normal.isApprox(Eigen::Vector3d::UnitX(), 1e-12));
  EXPECT_NEAR(contacts[0].plane, half.x() + kOffset, kTolerance);
  // What moves past the edge by itself gets the plane at the edge, and so does what iterations
  // brought there.
  for (const bool moves : {true, false}) {
    const auto at_edge = c.find(from, to, moves ? Eigen::Vector3d((to - from) / kDt) : none, moves);
    ASSERT_EQ(at_edge.size(), 1u);
    EXPECT_GT(-at_edge[0].normal.z(), 0.1) << moves;
  }
}

// What is pressed from above is predicted to fall, farther than the margin in a long step, and does
// not. Only what begins near the surface is held.
TEST(ContactDetection, WhatIsPressedFromAboveStaysInContact) {
  const Eigen::Vector3d fall(0, 0, -9.81 * kDt * kDt), none = Eigen::Vector3d::Zero();
  ASSERT_GT(fall.norm(), 1.5 * kMargin);
  for (const bool is_carried : {true, false}) {
    CarriedCase c("box");
    const auto* box = as<Box>(*c.obstacles[0].shape);
    ASSERT_NE(box, nullptr);
    const double bottom = -0.5 * box->size().z();
    const auto find = [&](double gap) {
      const Eigen::Vector3d from(0.001, 0.002, bottom - kOffset - gap);
      return is_carried ? c.find(from, from + fall, none, true) : c.Case::find(from, from + fall);
    };
    const auto held = find(0.0);
    ASSERT_EQ(held.size(), 1u) << is_carried;
    EXPECT_TRUE(held[0].normal.isApprox(-Eigen::Vector3d::UnitZ(), 1e-12));
    EXPECT_NEAR(held[0].plane, -bottom + kOffset, kTolerance);
    EXPECT_TRUE(find(1.1 * kMargin).empty()) << is_carried;
  }
}

// The motion of the surface is that of the place where the point stands, not of the place where the
// step predicts it, in which gravity and the turn itself have a part.
TEST(ContactDetection, WhatSticksGoesWithThePlaceWhereItIs) {
  Case c("box");
  const auto* box = as<Box>(*c.obstacles[0].shape);
  ASSERT_NE(box, nullptr);
  const Eigen::Vector3d from(0.02, 0.03, 0.5 * box->size().z() + kOffset);
  Obstacle& turntable = c.obstacles[0];
  turntable.pose_end.linear() =
      Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  // As far as it would fly on, its velocity is along the circle.
  const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(0.05 * from);
  for (const double fall : {0.0, 0.4 * kOffset}) {
    const auto contacts = c.find(from, from + along - Eigen::Vector3d(0, 0, fall));
    ASSERT_EQ(contacts.size(), 1u);
    const Eigen::Vector3d stuck = turntable.pose_end * from;
    EXPECT_LT((from + contacts[0].surface_motion - stuck).norm(), 1e-6 * from.norm()) << fall;
  }
}

/// A wall at x = 0 and a floor at z = 0 in one piece.
class Corner final : public Shape {
 public:
  SurfacePoint query(const Eigen::Vector3d& p) const override {
    if (p.x() < p.z()) return {p.x(), Eigen::Vector3d::UnitX()};
    return {p.z(), Eigen::Vector3d::UnitZ()};
  }
  Eigen::AlignedBox3d bounds() const override {
    return {Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1)};
  }
  TriangleMesh surface() const override { return {}; }
  std::string name() const override { return "corner"; }
  bool convex() const override { return false; }
};

// The wall would not keep it from the floor that it falls to.
TEST(ContactDetection, WhatFallsToTheFloorOfACornerIsKeptFromTheFloor) {
  CarriedCase c("box");
  c.obstacles[0].shape = std::make_shared<Corner>();
  const Eigen::Vector3d from(1.05 * kOffset, 0.0, 1.1 * kOffset);
  const auto contacts =
      c.find(from, from - Eigen::Vector3d(0, 0, 0.4 * kOffset), Eigen::Vector3d::Zero(), true);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].normal, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(contacts[0].plane, kOffset, kTolerance);
}

TEST(ContactDetection, NoParticlesOrObstacles) {
  std::vector<Contact> contacts;
  std::vector<Obstacle> none;
  ContactDetection(none, kOffset, kMargin)
      .find(Particles(Positions::Zero(3, 2), Eigen::VectorXd::Ones(2)), kDt, contacts);
  EXPECT_TRUE(contacts.empty());
  Case c("sphere");
  ContactDetection(c.obstacles, kOffset, kMargin)
      .find(Particles(Positions(3, 0), Eigen::VectorXd(0)), kDt, contacts);
  EXPECT_TRUE(contacts.empty());
}

TEST(ContactDetection, ContactsComeInOrder) {
  std::vector<Obstacle> obstacles{obstacle(Plane()), obstacle(Sphere(0.1))};
  Positions x = Positions::Zero(3, 3);
  x.row(2).setConstant(0.05);
  Particles p(x, Eigen::VectorXd::Ones(3));
  p.x.row(2).setConstant(-0.05);
  std::vector<Contact> contacts;
  ContactDetection(obstacles, kOffset, kMargin).find(p, kDt, contacts);
  ASSERT_EQ(contacts.size(), 6u);
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(contacts[static_cast<std::size_t>(k)].obstacle, k / 3);
    EXPECT_EQ(contacts[static_cast<std::size_t>(k)].point, k % 3);
  }
}

/// A heap of particles and a moving obstacle, stepped many times with one ContactDetection, whose
/// clear balls live on from step to step; checked against the distance along the whole path.
class BruteForce {
 public:
  BruteForce(const std::string& shape, std::uint64_t seed)
      : random_(seed),
        obstacles_(1),
        detection_(obstacles_, kOffset, kMargin),
        particles_(random_.positions(kCount, 0.4), Eigen::VectorXd::Ones(kCount)) {
    obstacles_[0].shape = primitive(shape);
    for (int i = 0; i < kCount; ++i) {
      while (distance(i, 1.0) < 2.0 * kOffset) particles_.x.col(i) = random_.vector(0.4);
    }
  }

  void step(double particle_step, double obstacle_step, double turn) {
    Obstacle& o = obstacles_[0];
    o.pose_start = o.pose_end;
    o.pose_end.translation() += random_.vector(obstacle_step) - 0.02 * o.pose_end.translation();
    const Eigen::Vector3d axis = random_.vector(1.0).normalized();
    o.pose_end.linear() =
        Eigen::AngleAxisd(random_(0, turn), axis).toRotationMatrix() * o.pose_end.linear();
    particles_.x_start = particles_.x;
    for (int i = 0; i < kCount; ++i) particles_.x.col(i) += random_.vector(particle_step);
    std::vector<Contact> contacts;
    detection_.find(particles_, kDt, contacts);
    std::vector<bool> touched(kCount, false);
    for (const Contact& c : contacts) {
      touched[static_cast<std::size_t>(c.point)] = true;
      const double gap = c.normal.dot(particles_.x.col(c.point)) - c.plane;
      if (gap < 0.0) particles_.x.col(c.point) -= gap * c.normal;
    }
    for (int i = 0; i < kCount; ++i) check(i, touched[static_cast<std::size_t>(i)]);
  }

 private:
  static constexpr int kCount = 60;

  /// Of particle i from the obstacle after a share `t` of the step.
  double distance(int i, double t) const {
    const Obstacle& o = obstacles_[0];
    const Eigen::Vector3d from = o.pose_start.inverse() * particles_.x_start.col(i);
    const Eigen::Vector3d to = o.pose_end.inverse() * particles_.x.col(i);
    return o.shape->distance((1.0 - t) * from + t * to);
  }

  void check(int i, bool touched) const {
    ASSERT_GE(distance(i, 1.0), kOffset - kTolerance) << "particle " << i;
    if (touched) return;
    // A displacement shorter than half the offset is not swept: it may dip to half the offset.
    for (int k = 0; k < 50; ++k) ASSERT_GE(distance(i, k / 50.0), 0.5 * kOffset - kTolerance);
  }

  Random random_;
  std::vector<Obstacle> obstacles_;
  ContactDetection detection_;
  Particles particles_;
};

TEST_P(EveryPrimitive, NothingIsMissed) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    BruteForce run(GetParam(), seed);
    for (int k = 0; k < 60; ++k) run.step(2e-4, 1e-4, 1e-3);
    for (int k = 0; k < 60; ++k) run.step(1e-2, 1e-2, 0.1);
    for (int k = 0; k < 60; ++k) run.step(0.3, 0.1, 1.0);
    for (int k = 0; k < 60; ++k) run.step(1e-5, 0.0, 0.0);
    if (testing::Test::HasFatalFailure()) return;
  }
}

/// The contacts of two solid balls of 1 cm, the second in the origin, of which the first goes from
/// `from` to `to` in a millisecond.
std::vector<PairContact> contacts_of_two_balls(const Eigen::Vector3d& from,
                                               const Eigen::Vector3d& to) {
  BodyGeometry ball;
  ball.interior_points = Eigen::Matrix3Xd::Zero(3, 1);
  ball.volume = 1e-6;
  ParticleWorld t(1e-3);
  t.add(ball, {}, from);
  t.add(ball, {});
  Particles& p = t.particles();
  p.x_start = p.x;
  p.x.col(0) = to;
  ParticleContactDetection detection(t.model(), {0.002, kMargin, 0.5});
  std::vector<PairContact> contacts;
  detection.find(p, 1e-3, contacts);
  return contacts;
}

TEST(ParticleContactDetection, BallsThatRestAsideKeepTheirSizeFromEachOther) {
  for (const double distance : {0.01, 0.01 + 0.9 * kMargin}) {
    const Eigen::Vector3d place(0.0, distance, 0.0);
    const auto contacts = contacts_of_two_balls(place, place);
    ASSERT_EQ(contacts.size(), 1u) << distance;
    EXPECT_TRUE(contacts[0].normal.isApprox(Eigen::Vector3d::UnitY(), 1e-12));
    EXPECT_NEAR(contacts[0].least, 0.01, 1e-15) << distance;
  }
}

// Where they go meanwhile says nothing of how they came to overlap.
TEST(ParticleContactDetection, BallsThatOverlapAreOpenedSlowlyAlongWhereTheyLie) {
  const auto contacts = contacts_of_two_balls({0.0, 0.0, 0.008}, {0.004, 0.0, 0.004});
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_TRUE(contacts[0].normal.isApprox(Eigen::Vector3d::UnitZ(), 1e-12))
      << contacts[0].normal.transpose();
  // By a millimetre in a millisecond.
  EXPECT_NEAR(contacts[0].least, 0.009, 1e-15);
}

}  // namespace
}  // namespace pliant::contact_detection_test
