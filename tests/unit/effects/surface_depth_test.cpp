// How deep the surface of a body is in an obstacle between the points that touch.
#include "pliant/effects/contact/surface_depth.h"

#include <gtest/gtest.h>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "support/worlds/worlds.h"

namespace pliant::surface_depth_test {
namespace {

/// A tetrahedron with edges of 0.1 m along the axes, and its surface: three corners and the middle
/// of the fourth one and the first. The plane z = 0 is below `height` [m].
class SurfaceDepthTest : public testing::Test {
 protected:
  std::vector<std::string> warnings(double height, std::uint64_t step = 1, double force = 1.0) {
    Positions x(3, 4);
    x << 0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0.1, 0;
    x.row(2).array() += height;
    const Particles particles(x, Eigen::VectorXd::Ones(4));
    Eigen::Matrix4Xi carriers = Eigen::Vector4i(0, 1, 2, 3).replicate(1, 4);
    Eigen::Matrix4Xd weights = Eigen::Matrix4d::Identity();
    weights.col(3) = Eigen::Vector4d(0.5, 0, 0, 0.5);
    const EmbeddedPoints surface(carriers, weights);
    Contact contact;
    contact.obstacle = 1;
    contact.normal_force = force;
    StepReport report;
    report.step = step;
    const std::vector<Obstacle> obstacles = {obstacle(Sphere(1.0), at(0, 0, -5)),
                                             obstacle(Plane())};
    SurfaceDepth(&surface).look(particles, obstacles, {contact}, report);
    return report.warnings;
  }
};

TEST_F(SurfaceDepthTest, IsToldBeyondTwoPercentOfTheSize) {
  // The longest side of the box about the surface is 0.1 m.
  EXPECT_TRUE(warnings(0.0).empty());
  EXPECT_TRUE(warnings(-0.0019).empty());
  ASSERT_EQ(warnings(-0.0021).size(), 1u);
  EXPECT_NE(warnings(-0.004).front().find("is about 4 mm deep in an obstacle: give the body's "
                                          "geometry a smaller `contact_spacing`"),
            std::string::npos)
      << warnings(-0.004).front();
}

TEST_F(SurfaceDepthTest, OnlyOfWhatPressesTheBody) {
  EXPECT_TRUE(warnings(-0.004, 1, 0.0).empty());
}

TEST_F(SurfaceDepthTest, IsLookedAtSeldomInALongRun) {
  EXPECT_FALSE(warnings(-0.004, 16).empty());
  EXPECT_TRUE(warnings(-0.004, 17).empty());
  EXPECT_FALSE(warnings(-0.004, 24).empty());
}

TEST_F(SurfaceDepthTest, ABodyWhosePointsAreAllOfItHasNone) {
  StepReport report;
  Contact contact;
  contact.obstacle = 0;
  contact.normal_force = 1.0;
  SurfaceDepth(nullptr).look({}, {obstacle(Plane())}, {contact}, report);
  EXPECT_TRUE(report.warnings.empty());
}

}  // namespace
}  // namespace pliant::surface_depth_test
