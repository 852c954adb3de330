// Contact between bodies where pairs have numbers of their own.
#include "support/worlds/body_pairs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "support/worlds/worlds.h"

namespace pliant::body_pairs_physics_test {
namespace {

constexpr double kGravity = 9.81;

std::string box(const std::string& name, double x, double z, const Eigen::Vector3d& size,
                const std::string& more = "") {
  return fmt::format(
      "  - {{name: {}, model: rigid, geometry: {{box: {{size: [{}, {}, {}]}}}}, material: "
      "{{density: 500}}, position: [{}, 0, {}]{}}}\n",
      name, size.x(), size.y(), size.z(), x, z, more.empty() ? "" : ", " + more);
}

const char* const kHeld =
    "attachments: [{name: hold, sphere: {center: [0, 0, 0], radius: 1}, to: world, stiffness: "
    "1.0e+6}]";

std::string gravity_on_slope(double angle) {
  return fmt::format("  gravity: {{acceleration: [{}, 0, {}]}}\n", kGravity * std::sin(angle),
                     -kGravity * std::cos(angle));
}

double speed_along(World& world, const std::string& name) {
  const Particles& particles = body_named(world, name).particles();
  return particles.momentum().x() / particles.mass.sum();
}

double lowest_of(World& world, const std::string& name) {
  return body_named(world, name).model->surface().vertices.row(2).minCoeff();
}

double highest_of(World& world, const std::string& name) {
  return body_named(world, name).model->surface().vertices.row(2).maxCoeff();
}

TEST(BodyPairContact, EachPairHasItsFriction) {
  const double slope = 0.4, angle = std::atan(slope);
  const std::vector<std::string> bodies = {box("ramp", 0.0, 0.0, {0.6, 0.1, 0.05}, kHeld),
                                           box("rough", -0.15, 0.052, {0.1, 0.1, 0.05}),
                                           box("smooth", 0.1, 0.052, {0.1, 0.1, 0.05})};
  const auto world = world_of(scene_text(
      bodies, gravity_on_slope(angle) +
                  fmt::format("  body_contact: {{friction: {}, pairs: [{{bodies: [smooth, ramp], "
                              "friction: {}}}]}}\n",
                              1.05 * slope, 0.5 * slope)));
  for (int k = 0; k < 8; ++k) ASSERT_TRUE(world->step());
  const double rough = speed_along(*world, "rough"), smooth = speed_along(*world, "smooth");
  constexpr int kSteps = 24;
  for (int k = 0; k < kSteps; ++k) ASSERT_TRUE(world->step());
  const double seconds = kSteps * world->time_step();
  const double slips = 0.5 * kGravity * std::sin(angle);
  EXPECT_LT(std::abs(speed_along(*world, "rough") - rough) / seconds, 0.02);
  EXPECT_NEAR((speed_along(*world, "smooth") - smooth) / seconds, slips, 0.02 * slips);
}

TEST(BodyPairContact, EachPairKeepsItsThickness) {
  const std::vector<std::string> bodies = {box("base", 0.0, 0.0, {0.4, 0.1, 0.05}, kHeld),
                                           box("left", -0.1, 0.053, {0.1, 0.1, 0.05}),
                                           box("right", 0.1, 0.056, {0.1, 0.1, 0.05})};
  const auto world = world_of(
      scene_text(bodies,
                 "  gravity: {}\n  damping: {rate: 2}\n  body_contact: {thickness: 0.002, pairs: "
                 "[{bodies: [base, right], thickness: 0.005}, {bodies: [left, base], thickness: "
                 "0.001}]}\n"));
  run_for(*world, 0.8);
  const double top = highest_of(*world, "base");
  EXPECT_NEAR(lowest_of(*world, "left") - top, 0.001, 1e-5);
  EXPECT_NEAR(lowest_of(*world, "right") - top, 0.005, 5e-5);
}

TEST(BodyPairContact, ThoseThatAreLeftOutPassWithoutAWarning) {
  const std::vector<std::string> bodies = {box("base", 0.0, 0.0, {0.3, 0.1, 0.05}, kHeld),
                                           box("ghost", -0.1, 0.06, {0.1, 0.1, 0.05}),
                                           box("solid", 0.1, 0.06, {0.1, 0.1, 0.05})};
  const auto world =
      world_of(scene_text(bodies, "  gravity: {}\n  body_contact: {except: [[ghost, base]]}\n"));
  double fallen = 0.0;
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(world->step());
    fallen += kGravity * world->time_step() * world->time_step() * (k + 1);
    for (const Body& body : world->bodies()) {
      for (const std::string& warning : body.report.warnings) {
        EXPECT_EQ(warning.find("bodies_pass"), std::string::npos) << warning;
      }
    }
  }
  const auto height = [&](const char* name) {
    return body_named(*world, name).particles().center_of_mass().z();
  };
  EXPECT_NEAR(height("ghost"), 0.06 - fallen, 1e-6);
  EXPECT_GT(height("solid"), 0.05);
}

TEST(BodyPairContact, IsTheSameForAnyNumberOfThreads) {
  const std::string text = scene_text(
      {box("base", 0.0, 0.0, {0.4, 0.1, 0.05}, kHeld), slab("soft", "patch", 0.08),
       slab("sheet", "cloth", 0.12)},
      "  gravity: {}\n  body_contact: {pairs: [{bodies: [soft, base], friction: 0.1, thickness: "
      "0.004}], except: [[base, sheet]]}\n");
  const auto end = [&](int threads) {
    set_threads(threads);
    const auto world = world_of(text);
    for (int k = 0; k < 40; ++k) EXPECT_TRUE(world->step());
    set_threads(1);
    return body_named(*world, "sheet").particles().x;
  };
  const Positions one = end(1);
  EXPECT_EQ(one, end(2));
  EXPECT_EQ(one, end(3));
}

}  // namespace
}  // namespace pliant::body_pairs_physics_test
