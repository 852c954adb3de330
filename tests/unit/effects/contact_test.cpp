#include "pliant/effects/contact/contact.h"

#include <gtest/gtest.h>

#include "support/expect_refusal.h"
#include "support/meshes/shapes.h"
#include "support/worlds/worlds.h"

namespace pliant {
namespace {

class ContactOfEverySolver : public EverySolver {
 protected:
  /// A soft cloth at its contact distance above a plane at z = 0.
  ClothScene scene() const {
    ClothScene scene;
    scene.solver = GetParam();
    scene.material = soft_material();
    scene.time_step = 1e-3;
    scene.obstacles = {obstacle(Plane())};
    scene.pose = at(0, 0, 0.001);
    scene.effects = {{"gravity", {}}, {"contact", {}}};
    return scene;
  }
};
PLIANT_FOR_EVERY_SOLVER(ContactOfEverySolver);

TEST_P(ContactOfEverySolver, HoldsTheWeight) {
  auto world = make_world(scene());
  run_for(*world, 0.02);
  const double weight = 9.81 * particles_of(*world).mass.sum();
  EXPECT_EQ(body_of(*world).report.contacts, 49);
  // Gaps close to round-off, 1e-18 m; over h² / m that is 1e-18 / 1e-6 * 3e-4 N each.
  EXPECT_NEAR(world->reactions()[0].force.z(), -weight, 1e-9 * weight);
  EXPECT_NEAR(world->reactions()[0].force.head<2>().norm(), 0.0, 1e-9 * weight);
  // The centre of mass is above the origin: no torque.
  EXPECT_NEAR(world->reactions()[0].torque.norm(), 0.0, 1e-9 * weight);
}

TEST_P(ContactOfEverySolver, TorqueIsAboutTheObstaclesOrigin) {
  ClothScene s = scene();
  s.obstacles = {obstacle(Plane(), at(0.3, -0.2, 0))};
  auto world = make_world(s);
  run_for(*world, 0.02);
  const double weight = 9.81 * particles_of(*world).mass.sum();
  const Eigen::Vector3d torque(0.2 * -weight, 0.3 * -weight, 0);
  EXPECT_LE((world->reactions()[0].torque - torque).norm(), 1e-9 * weight);
}

TEST_P(ContactOfEverySolver, DoesNotPull) {
  auto world = make_world(scene());
  particles_of(*world).v.row(2).setConstant(1.0);
  ASSERT_TRUE(world->step());
  EXPECT_EQ(body_of(*world).report.contacts, 0);
  EXPECT_TRUE(world->reactions()[0].force.isZero(0.0));
  EXPECT_NEAR(particles_of(*world).v(2, 20), 1.0 - 9.81e-3, 1e-9);
}

TEST_P(ContactOfEverySolver, DoesNotBounce) {
  ClothScene s = scene();
  s.pose = at(0, 0, 0.05);
  auto world = make_world(s);
  run_for(*world, 0.3);
  EXPECT_LE((particles_of(*world).x.row(2).array() - 0.001).abs().maxCoeff(), 1e-12);
}

TEST_P(ContactOfEverySolver, KeepsHalfTheThickness) {
  ClothScene s = scene();
  s.pose = at(0, 0, 0.02);
  s.effects = {{"gravity", {}}, {"contact", {{"thickness", "0.01"}}}};
  auto world = make_world(s);
  run_for(*world, 0.2);
  EXPECT_NEAR(particles_of(*world).x.row(2).minCoeff(), 0.005, 1e-12);
  EXPECT_EQ(effect_of<ContactEffect>(*world, "contact").offset(), 0.005);
}

TEST_P(ContactOfEverySolver, MovingObstacleLifts) {
  ClothScene s = scene();
  auto world = make_world(s);
  class Lift final : public ObstacleDriver {
   public:
    void drive(double time, std::vector<Obstacle>& obstacles) override {
      obstacles[0].pose_end = at(0, 0, 0.5 * time);
    }
  };
  world->add_driver(std::make_unique<Lift>());
  run_for(*world, 0.1);
  EXPECT_NEAR(particles_of(*world).x.row(2).minCoeff(), 0.051, 1e-9);
  EXPECT_NEAR(particles_of(*world).v.row(2).mean(), 0.5, 1e-6);
}

TEST(Contact, RefusesBadParameters) {
  auto world = make_world(ClothScene());
  const auto add = [&](const ParameterText& text) {
    world->add_effect(body_of(*world), effect_registry(), "contact", text, "test");
  };
  expect_refusal([&] { add({{"thickness", "0"}}); }, {"'thickness'", "> 0", "[m]"});
  expect_refusal([&] { add({{"margin", "-1"}}); }, {"'margin'", ">= 0", "[m]"});
}

/// A cloth that lies as near to a plane as contact lets it.
std::unique_ptr<World> cloth_on_a_plane() {
  ClothScene s;
  s.obstacles = {obstacle(Plane())};
  s.effects = {{"gravity", {}}, {"contact", {}}};
  s.pose = at(0, 0, 0.001);
  return make_world(s);
}

// Of all points that went into an obstacle the deepest tells how far from settled they are.
TEST(Contact, SettlingTellsOfTheDeepestPointAndTakesAllOut) {
  const auto world = cloth_on_a_plane();
  ASSERT_TRUE(world->step());
  auto& contact = effect_of<ContactEffect>(*world, "contact");
  const Eigen::VectorXd mobility = Eigen::VectorXd::Ones(particles_of(*world).size());
  const auto missed = [&](double depth) {
    Positions x = particles_of(*world).x;
    x.row(2).setConstant(0.001);
    x(2, 3) -= depth;
    x(2, 11) -= 0.5 * depth;
    const double result = contact.alternating_projection(mobility, x);
    EXPECT_LE((x.row(2).array() - 0.001).abs().maxCoeff(), 1e-15);
    return result;
  };
  // A tenth of the offset is much, a hundred-thousandth is nothing.
  EXPECT_GT(missed(1e-4), 1.0);
  EXPECT_LT(missed(1e-8), 1.0);
  EXPECT_NEAR(missed(2e-4), 2.0 * missed(1e-4), 1e-9 * missed(1e-4));
}

TEST(Contact, ResetForgetsContacts) {
  const auto world = cloth_on_a_plane();
  ASSERT_TRUE(world->step());
  EXPECT_FALSE(effect_of<ContactEffect>(*world, "contact").contacts().empty());
  world->reset();
  EXPECT_TRUE(effect_of<ContactEffect>(*world, "contact").contacts().empty());
}

}  // namespace
}  // namespace pliant
