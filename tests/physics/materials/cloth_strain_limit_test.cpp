// Cloth whose threads stretch no further than a limit, beside a point that is held too.
#include "pliant/effects/strain_limit/cloth_strain_limit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/effects/attachment.h"
#include "pliant/elements/cloth/triangle_strain_set.h"
#include "support/expect_refusal.h"
#include "support/measures.h"
#include "support/random.h"
#include "support/solvers/projective_model.h"
#include "support/solvers/solver_systems.h"
#include "support/solvers/stable_step.h"
#include "support/worlds/sheets.h"

namespace pliant::cloth_strain_limit_test {
namespace {

// A limit of 1 %, which may be missed by 1 %.
constexpr double kLimit = 0.01, kError = 0.01;

ClothScene held_by(const std::vector<int>& fixed, const GridOptions& grid) {
  ClothScene s;
  s.grid = grid;
  // So soft that without a limit its weight alone stretches it by far more.
  s.material = {
      {"stretch_warp", "20"}, {"stretch_weft", "20"}, {"shear", "2"}, {"bending", "1e-5"}};
  s.fixed = fixed;
  s.time_step = 1.0 / 60.0;
  s.effects = {{"gravity", {}}, {"damping", {{"rate", "2"}}}, {"strain_limit", {{"max", "1.01"}}}};
  return s;
}

class ClothStrainLimits : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(ClothStrainLimits);

TEST_P(ClothStrainLimits, HoldBesideOneVertex) {
  ClothScene scene = held_by({24}, {0.3, 0.3, 7, 7});
  scene.solver = solver();
  for (const bool is_limited : {false, true}) {
    if (!is_limited) scene.effects.pop_back();
    const auto world = make_stable_world(scene);
    double largest = 0.0;
    while (world->time() < 0.6) {
      ASSERT_TRUE(world->step()) << world->failure();
      largest = std::max(largest, largest_strain(*world));
    }
    if (is_limited) {
      EXPECT_LE(largest, kLimit + kError);
    } else {
      EXPECT_GT(largest, 0.05) << "the scene tests nothing";
    }
    if (!is_limited) scene.effects.push_back({"strain_limit", {{"max", "1.01"}}});
  }
}

// The row of threads between the two is nearly straight and carries all that hangs on it.
TEST_P(ClothStrainLimits, HoldBetweenTwoVertices) {
  const GridOptions grid{0.3, 0.3, 25, 25};
  ClothScene scene = held_by({vertex(grid, 8, 12), vertex(grid, 16, 12)}, grid);
  scene.solver = solver();
  scene.solver_parameters = few_iterations(solver(), 15);
  const auto world = make_stable_world(scene);
  double largest = 0.0;
  while (world->time() < 0.3) {
    ASSERT_TRUE(world->step()) << world->failure();
    largest = std::max(largest, largest_strain(*world));
  }
  EXPECT_LE(largest, kLimit + kError);
}

/// 2,500 vertices that lie on a table, for a hand at each of `hands`.
ClothScene on_a_table(const std::vector<int>& hands, const GridOptions& grid) {
  ClothScene scene = held_by(hands, grid);
  scene.material["stretch_warp"] = scene.material["stretch_weft"] = "1000";
  scene.obstacles = {obstacle(Plane())};
  scene.pose = at(0, 0, 0.001);
  scene.effects.push_back({"contact", {}});
  scene.effects.push_back({"friction", {}});
  scene.solver_parameters = {{"iterations", "15"}};
  return scene;
}

TEST(ClothStrainLimit, HoldsWhereAHandLifts2500Vertices) {
  const GridOptions grid{0.3, 0.3, 50, 50};
  const ClothScene scene = on_a_table({vertex(grid, 25, 25)}, grid);
  const auto world = make_world(scene);
  double largest = 0.0;
  for (int k = 0; k < 60; ++k) {
    // To 20 cm in a second: it hangs freely in the end.
    particles_of(*world).x(2, scene.fixed[0]) += 0.2 / 60.0;
    ASSERT_TRUE(world->step()) << world->failure();
    largest = std::max(largest, largest_strain(*world));
    EXPECT_NEAR(metric(body_of(*world).report, "largest_strain"), largest_strain(*world), 1e-12);
  }
  EXPECT_LE(largest, kLimit + kError);
  EXPECT_GT(lowest(*world), 0.0009) << "contact holds as well";
}

TEST(ClothStrainLimit, HoldsWhereTwoHandsLift2500Vertices) {
  const GridOptions grid{0.3, 0.3, 50, 50};
  const ClothScene scene = on_a_table({vertex(grid, 17, 25), vertex(grid, 33, 25)}, grid);
  const auto world = make_world(scene);
  double largest = 0.0;
  for (int k = 0; k < 75; ++k) {
    // To 20 cm in a second, and then they hold it.
    for (const int hand : scene.fixed) particles_of(*world).x(2, hand) += k < 60 ? 0.2 / 60.0 : 0.0;
    ASSERT_TRUE(world->step()) << world->failure();
    largest = std::max(largest, largest_strain(*world));
  }
  EXPECT_LE(largest, kLimit + kError);
}

TEST(ClothStrainLimit, HoldsWhereAHandComesAtFiveMetresASecond) {
  const GridOptions grid{0.3, 0.3, 26, 26};
  ClothScene scene = held_by({vertex(grid, 13, 13)}, grid);
  const auto world = make_world(scene);
  for (int k = 0; k < 30; ++k) {
    particles_of(*world).x(2, scene.fixed[0]) += k < 6 ? 5.0 / 60.0 : 0.0;
    ASSERT_TRUE(world->step()) << world->failure();
    EXPECT_LE(largest_strain(*world), kLimit + kError) << k;
  }
}

// By an attachment: tethers pull at it as hard as at what they hold.
TEST(ClothStrainLimit, HoldsBesideWhatAnAttachmentHolds) {
  const GridOptions grid{0.3, 0.3, 26, 26};
  ClothScene scene = held_by({}, grid);
  scene.effects[1].second = {{"rate", "10"}};
  const auto world = make_world(scene);
  AttachmentRequest request;
  request.name = "hand";
  const int held = vertex(grid, 13, 13);
  request.region.vertices = {held};
  const Eigen::Vector3d hook = particles_of(*world).x.col(held);
  request.count = grid.rows * grid.columns;
  request.stiffness = 1000.0;
  attachments_of(body_of(*world), world->obstacles()).attach_now(request, world->time_step());
  double largest = 0.0;
  Eigen::Vector3d pull = Eigen::Vector3d::Zero();  // of the spring, the mean of the last steps
  constexpr int kSteps = 200, kLast = 50;
  for (int k = 0; k < kSteps; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    largest = std::max(largest, largest_strain(*world));
    if (k < kSteps - kLast) continue;
    pull += request.stiffness / kLast * (hook - particles_of(*world).x.col(held));
  }
  EXPECT_LE(largest, kLimit + kError);
  // At rest the spring pulls with the weight, whatever the tethers and the final projection move.
  const double weight = 9.81 * particles_of(*world).mass.sum();
  EXPECT_LE((pull - Eigen::Vector3d(0, 0, weight)).norm(), 0.02 * weight);
}

TEST(ClothStrainLimit, HoldsWarpAndWeftOfTriangles) {
  auto world = sheet_world(
      disc(0.15, 8, 24), {},
      {{"gravity", {}}, {"damping", {{"rate", "2"}}}, {"strain_limit", {{"max", "1.01"}}}},
      1.0 / 60.0, {{"stretch_warp", "20"}, {"stretch_weft", "20"}, {"shear", "2"}});
  particles_of(*world).fix(0);
  world->system_changed();
  const auto& system = projective_system(*body_of(*world).model);
  const auto& triangles = dynamic_cast<TriangleStrainSet&>(*system.elements.front());
  for (int k = 0; k < 40; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    const double largest = triangles.stretches(particles_of(*world).x).maxCoeff() - 1.0;
    EXPECT_LE(largest, kLimit + kError) << k;
    EXPECT_NEAR(metric(body_of(*world).report, "largest_strain"), largest, 1e-12);
  }
}

TEST(ClothStrainLimit, KeepsMomentum) {
  for (const char* solver : {"xpbd", "verlet"}) {
    ClothScene scene = held_by({}, {0.3, 0.3, 11, 11});
    scene.effects = {{"strain_limit", {{"max", "1.01"}}}};
    scene.solver = solver;
    scene.time_step = 1e-3;
    const auto world = make_world(scene);
    Particles& p = particles_of(*world);
    Random random(7);
    p.v = random.positions(p.size(), 2.0);
    const Eigen::Vector3d before = p.momentum();
    const double scale = (p.v.colwise().norm() * p.mass)(0);
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(world->step()) << world->failure();
    EXPECT_GT(largest_strain(*world), 0.9 * kLimit) << solver << ": nothing is at the limit";
    // Velocities round to 1e-16 m / h = 1e-13 m/s in each step.
    EXPECT_LE((p.momentum() - before).norm(), 100 * 1e-13 * p.mass.sum() + 1e-13 * scale) << solver;
  }
}

TEST(ClothStrainLimit, IsTheSameForAnyNumberOfThreads) {
  const GridOptions grid{0.3, 0.3, 70, 70};  // large enough for its loops to be cut
  Positions one;
  for (const int count : {1, 2, 5}) {
    set_threads(count);
    const auto world = make_world(held_by({0, 69}, grid));
    for (int k = 0; k < 10; ++k) ASSERT_TRUE(world->step()) << world->failure();
    set_threads(1);
    if (count == 1) one = particles_of(*world).x;
    EXPECT_EQ(particles_of(*world).x, one) << count;
  }
}

TEST(ClothStrainLimit, RefusesWhatIsForTetrahedra) {
  for (const char* name : {"min", "stiffness"}) {
    ClothScene scene = held_by({0}, {0.3, 0.3, 7, 7});
    scene.effects = {{"strain_limit", {{"max", "1.01"}, {name, "0.5"}}}};
    expect_refusal([&] { make_world(scene); }, {"strain_limit", name, "tetrahedra", "leave"});
  }
}

TEST(ClothStrainLimit, SaysWhereItCannotHold) {
  ClothScene scene = held_by({0, 6}, {0.3, 0.3, 7, 7});
  const auto world = make_world(scene);
  ASSERT_TRUE(world->step());
  EXPECT_FALSE(warns(*world, "strain_limit"));
  particles_of(*world).x(0, 6) += 0.03;  // 10 % further from the other than the cloth is wide
  ASSERT_TRUE(world->step());
  EXPECT_TRUE(warns(*world, "strain_limit"));
  EXPECT_TRUE(particles_of(*world).x.allFinite());
}

TEST(ClothStrainLimit, RefusesClothThatHasNoThreads) {
  ClothScene scene = held_by({}, {0.3, 0.3, 7, 7});
  scene.material["stretch_warp"] = scene.material["stretch_weft"] = "0";
  EXPECT_THROW(make_world(scene), InputError);
}

}  // namespace
}  // namespace pliant::cloth_strain_limit_test
