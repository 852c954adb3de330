// Cloth that falls onto itself: an independent test of every edge with every
// triangle finds nothing that passed.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "support/meshes/intersections.h"
#include "support/solvers/stable_step.h"
#include "support/worlds/crumpling_sheet.h"
#include "support/worlds/drivers.h"

namespace pliant::cloth_self_contact_test {
namespace {

int intersections(const World& world) {
  const Body& body = world.bodies().front();
  return count_intersections(body.particles().x, body.model->surface_triangles());
}

/// Steps, and looks `times` at equal intervals whether anything passed.
void expect_nothing_passes(World& world, double seconds, int times) {
  for (int k = 1; k <= times; ++k) {
    while (world.time() < seconds * k / times - 0.5 * world.time_step()) {
      ASSERT_TRUE(world.step()) << world.failure();
    }
    EXPECT_EQ(intersections(world), 0) << world.time();
  }
}

class ClothSelfContact : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(ClothSelfContact);

TEST_P(ClothSelfContact, AFallingSheetCrumplesAndDoesNotPass) {
  ClothScene scene = crumpling_sheet();
  scene.solver = solver();
  scene.solver_parameters = few_iterations(solver(), 30);
  const auto world = make_stable_world(scene);
  expect_nothing_passes(*world, 0.8, 8);
  EXPECT_LT(body_of(*world).particles().x.row(2).maxCoeff(), 0.15) << "it still stands";
}

TEST(ClothSelfContactScene, PassesThroughItselfWithout) {
  ClothScene scene = crumpling_sheet(false);
  scene.solver = "lbfgs";
  scene.solver_parameters = {{"iterations", "30"}};
  const auto world = make_world(scene);
  int most = 0;
  for (int step = 1; step <= 160; ++step) {
    ASSERT_TRUE(world->step()) << world->failure();
    if (step % 20 == 0) most = std::max(most, intersections(*world));
  }
  EXPECT_GT(most, 50) << "the scene tests nothing";
}

/// Folded along x in its middle: the right half lies `gap` over the left one, upside down.
void fold(Positions& x, double gap) {
  for (auto p : x.colwise()) {
    if (p.x() <= 0.0) continue;
    p.x() = -p.x();
    p.z() += gap;
  }
}

TEST_P(ClothSelfContact, LaidExactlyOnItselfOpens) {
  ClothScene scene;
  scene.grid = {0.21, 0.21, 8, 8};
  scene.solver = solver();
  scene.material = soft_material();
  scene.effects = {{"self_contact", {{"thickness", "0.002"}, {"friction", "0"}}}};
  const auto world = make_stable_world(scene);
  fold(body_of(*world).particles().x, 0.0);
  run_for(*world, 0.1);
  EXPECT_EQ(intersections(*world), 0);
}

class ClothThrownOverItself : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(ClothThrownOverItself);

// One side of a wet sheet leaves the table at 5 m/s and comes down on the rest.
TEST_P(ClothThrownOverItself, AtFiveMetresASecondDoesNotPass) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, 16, 16};
  scene.material = fabric_of_sheets();
  scene.pose = at(0, 0, 0.002);
  scene.obstacles = {obstacle(Plane())};
  scene.effects = {{"gravity", {}},
                   {"damping", {{"rate", "0.5"}}},
                   {"self_contact", {{"thickness", "0.004"}}},
                   {"contact", {{"thickness", "0.004"}}},
                   {"friction", {}},
                   {"wetness", {{"adhesion", "36"}, {"adhesion_range", "0.004"}}}};
  scene.solver = solver();
  scene.solver_parameters = few_iterations(solver(), 30);
  const auto world = make_stable_world(scene);
  Particles& particles = body_of(*world).particles();
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.x(0, i) > 0.05) particles.v.col(i) << -3.0, 0.5, 4.0;
  }
  double lowest_edge = 1.0;
  for (int k = 1; k <= 10; ++k) {
    expect_nothing_passes(*world, 0.05 * k, 1);
    lowest_edge = std::min(lowest_edge, particles.x.row(0).maxCoeff());
  }
  EXPECT_LT(lowest_edge, 0.1) << "it did not come over";
}

// A hand comes at 5 m/s at a cloth that hangs by its upper corners, 25 mm in each step.
class ClothAndHand : public EverySolver {
 protected:
  static constexpr double kHand = 0.04;  // its radius [m]
  static constexpr double kStop = 0.06;  // [s], 15 cm behind where the cloth hung

  std::unique_ptr<World> hanging(bool is_limited, const ParameterText& parameters) const {
    ClothScene scene;
    scene.grid = {0.3, 0.3, 16, 16};
    scene.material = fabric_of_sheets();
    scene.pose.linear() =
        Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
    scene.fixed = {240, 255};
    scene.obstacles = {obstacle(Sphere(kHand), at(0, 0.15, 0.03))};
    scene.effects = {{"gravity", {}}, {"damping", {{"rate", "0.5"}}}};
    if (is_limited) scene.effects.push_back({"strain_limit", {{"max", "1.01"}}});
    scene.effects.push_back({"self_contact", {{"thickness", "0.004"}}});
    scene.effects.push_back({"contact", {{"thickness", "0.004"}}});
    scene.effects.push_back({"friction", {}});
    scene.solver = solver();
    scene.solver_parameters = parameters;
    auto world = make_stable_world(scene);
    world->add_driver(std::make_unique<StraightDriver>(0, scene.obstacles[0].pose_end,
                                                       Eigen::Vector3d(0, -5, 0), kStop));
    return world;
  }

  // In a step it comes by less than a third of its width, and it is four cells wide: it cannot pass
  // without a vertex in it.
  static void expect_to_pass_nothing(World& world) {
    const Positions& x = particles_of(world).x;
    double next = 0.0;
    while (world.time() < 0.25) {
      ASSERT_TRUE(world.step()) << world.failure();
      const Eigen::Vector3d center = world.obstacles()[0].pose_end.translation();
      ASSERT_GE((x.colwise() - center).colwise().norm().minCoeff(), kHand) << world.time();
      if (world.time() < next) continue;
      next += 0.02;
      EXPECT_EQ(intersections(world), 0) << world.time();
    }
  }
};
PLIANT_FOR_EVERY_SOLVER(ClothAndHand);

TEST_P(ClothAndHand, AtFiveMetresASecondPassNothing) {
  expect_to_pass_nothing(*hanging(false, few_iterations(solver(), 30)));
}

class LimitedClothAndHand : public ClothAndHand {};
PLIANT_FOR_EVERY_SOLVER(LimitedClothAndHand);

TEST_P(LimitedClothAndHand, AtFiveMetresASecondPassNothing) {
  expect_to_pass_nothing(*hanging(true, few_iterations(solver(), 30)));
}

// What limits and hand ask for contradicts itself, and a correction of all vertices at once answers
// with ten cells: three of them are not enough to mend what one did.
class FewCorrections : public ClothAndHand {};
INSTANTIATE_TEST_SUITE_P(Solvers, FewCorrections, testing::Values("direct", "lbfgs"), test_name_of);

TEST_P(FewCorrections, DoNotTearTheClothApart) {
  const auto world = hanging(true, with_iterations(solver(), 3));
  expect_to_pass_nothing(*world);
  EXPECT_LT(extent(*world), 0.5);
}

TEST(ClothSelfContactScene, ForcesArePairs) {
  ClothScene scene = crumpling_sheet();
  scene.obstacles.clear();
  scene.effects = {{"self_contact", {{"thickness", "0.004"}}}};
  scene.solver_parameters = {{"iterations", "30"}};
  const auto world = make_world(scene);
  Particles& particles = body_of(*world).particles();
  // Its halves clap together.
  for (int i = 0; i < particles.size(); ++i) {
    particles.v(1, i) = particles.x(0, i) < 0.0 ? 1.0 : 0.0;
    particles.v(0, i) = -8.0 * particles.x(0, i);
  }
  const Eigen::Vector3d before = particles.momentum();
  const double scale = particles.mass.sum();
  for (int step = 0; step < 60; ++step) ASSERT_TRUE(world->step()) << world->failure();
  EXPECT_LE((particles.momentum() - before).norm(), 1e-10 * scale);
}

}  // namespace
}  // namespace pliant::cloth_self_contact_test
