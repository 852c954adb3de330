// Effects that add element sets to a body of tetrahedra: volume and strain_limit.
#include <gtest/gtest.h>

#include "pliant/effects/strain_limit/strain_limit.h"
#include "pliant/effects/volume.h"
#include "support/expect_refusal.h"
#include "support/solvers/projective_model.h"
#include "support/worlds/solid_world.h"

namespace pliant {
namespace {

const BlockOptions kBar{{0.3, 0.1, 0.1}, {6, 2, 2}};
constexpr double kYoung = 1e5;  // [Pa]

/// A bar of Poisson's ratio 0 along x, in steps so long that it is at rest after a few.
SolidScene bar(bool is_far_end_fixed) {
  SolidScene scene;
  const TetrahedralMesh mesh = make_block(kBar);
  scene.parts = {{mesh, Eigen::Isometry3d::Identity(), {kYoung, 0.0, 1000.0}}};
  for (int i = 0; i < mesh.vertices.cols(); ++i) {
    const bool far = is_far_end_fixed && on_face(mesh, i, 0, 1);
    if (on_face(mesh, i, 0, -1) || far) scene.fixed.push_back(i);
  }
  scene.time_step = 1.0;
  scene.solver_parameters = {{"iterations", "200"}, {"tolerance", "1e-11"}};
  return scene;
}

/// At rest with its ends `stretch` times as far apart.
std::unique_ptr<World> stretched(const SolidScene& scene, double stretch) {
  auto world = make_solid_world(scene);
  particles_of(*world).x.row(0) *= stretch;
  run_for(*world, 30.0);
  return world;
}

Eigen::ArrayXd relative_volumes(const World& world) {
  const SolidModel& model = solid_of(world);
  return volumes({model.particles().x, model.tetrahedra()->tetrahedra}).array() /
         volumes(*model.tetrahedra()).array();
}

double volume_of(const World& world) {
  return volumes({solid_of(world).particles().x, solid_of(world).tetrahedra()->tetrahedra}).sum() /
         kBar.size.prod();
}

TEST(VolumeEffect, APulledBarKeepsItsVolume) {
  SolidScene scene = bar(true);
  double last = volume_of(*stretched(scene, 1.2)) - 1.0;
  EXPECT_NEAR(last, 0.2, 1e-9);
  for (const char* stiffness : {"1e5", "1e6", "1e7"}) {
    scene.effects = {{"volume", {{"stiffness", stiffness}}}};
    const double left = volume_of(*stretched(scene, 1.2)) - 1.0;
    EXPECT_LT(std::abs(left), 0.7 * last) << stiffness;
    last = std::abs(left);
  }
  EXPECT_LT(last, 0.01);
}

TEST(VolumeEffect, ReportsTheErrorItLeaves) {
  SolidScene scene = bar(true);
  scene.effects = {{"volume", {{"stiffness", "1e5"}}}};
  auto world = stretched(scene, 1.2);
  const Eigen::ArrayXd errors = (relative_volumes(*world) - 1.0).abs();
  const StepReport& report = body_of(*world).report;
  EXPECT_NEAR(metric(report, "volume_error"), errors.maxCoeff(), 1e-12);
  EXPECT_NEAR(metric(report, "mean_volume_error"), errors.mean(), 1e-12);
  EXPECT_GT(errors.mean(), 0.01);
}

TEST(VolumeEffect, LimitsLeaveRoom) {
  SolidScene scene = bar(true);
  const Positions free = particles_of(*stretched(scene, 1.1)).x;
  scene.effects = {{"volume", {{"stiffness", "1e7"}, {"min", "0.5"}, {"max", "2"}}}};
  EXPECT_LE((particles_of(*stretched(scene, 1.1)).x - free).cwiseAbs().maxCoeff(), 1e-9);
  scene.effects = {{"volume", {{"stiffness", "1e7"}, {"min", "0.5"}, {"max", "1.05"}}}};
  EXPECT_NEAR(volume_of(*stretched(scene, 1.1)), 1.05, 0.005);
}

/// Largest strain of the bar that its own weight pulls; its effect `strain_limit` says so.
double largest_strain_under_load(const char* stiffness) {
  SolidScene scene = bar(false);
  scene.effects = {{"gravity", {{"acceleration", "[133, 0, 0]"}}},
                   {"strain_limit", {{"min", "0.8"}, {"max", "1.2"}, {"stiffness", stiffness}}}};
  auto world = make_solid_world(scene);
  run_for(*world, 30.0);
  return metric(body_of(*world).report, "largest_strain");
}

TEST(StrainLimitEffect, HoldsAsFarAsItsStiffnessAllows) {
  // Stress E e up to the limit, and (E + k) more for each strain beyond. All but the half of a
  // layer next to the held end pulls at that layer.
  const double stress = 133.0 * 1000.0 * (kBar.size[0] - 0.5 * kBar.size[0] / kBar.cells[0]);
  for (const char* stiffness : {"1e5", "1e6", "1e7"}) {
    const double k = std::stod(stiffness);
    const double beyond = (stress - 0.2 * kYoung) / (kYoung + k);
    // That is the layer's mean; its tetrahedra differ, since vertices of the block differ in mass.
    const double strain = largest_strain_under_load(stiffness);
    EXPECT_GT(strain, 0.2 + beyond) << stiffness;
    EXPECT_LT(strain, 0.2 + 2.0 * beyond) << stiffness;
  }
}

TEST(StrainLimitEffect, CountsInvertedTetrahedraAsNegativeStretches) {
  const TetrahedralMesh mesh = make_block(kBar);
  const StrainLimitSet set(mesh, 1.0, {0.8, 1.2});
  const auto strain = [&](double a, double b, double c) {
    return set.largest_strain(Eigen::Vector3d(a, b, c).asDiagonal() * mesh.vertices);
  };
  EXPECT_NEAR(strain(1.0, 1.0, 1.0), 0.0, 1e-7);
  EXPECT_NEAR(strain(1.5, 1.0, 0.7), 0.5, 1e-12);
  EXPECT_NEAR(strain(1.1, 1.0, 0.7), 0.3, 1e-12);
  EXPECT_NEAR(strain(1.1, 1.0, -0.7), 1.7, 1e-12);
  EXPECT_NEAR(strain(0.0, 0.0, 0.0), 1.0, 1e-12);
}

TEST(TetrahedraEffects, AreNotThereUnlessNamed) {
  const SolidScene without = bar(true);
  SolidScene with = without;
  with.effects = {{"volume", {}}, {"strain_limit", {}}};
  const auto sets = [](const World& world) {
    return projective_system(solid_of(world)).elements.size();
  };
  auto bare = make_solid_world(without), full = make_solid_world(with);
  EXPECT_EQ(sets(*full), sets(*bare) + 2);
  ASSERT_TRUE(bare->step());
  for (const Metric& metric : body_of(*bare).report.metrics) {
    EXPECT_NE(metric.name, "volume_error");
    EXPECT_NE(metric.name, "largest_strain");
  }
}

TEST(TetrahedraEffects, ResetAndCheckpointsGoOnBitForBit) {
  SolidScene scene = bar(true);
  scene.time_step = 0.01;
  scene.effects = {{"gravity", {}}, {"volume", {}}, {"strain_limit", {{"max", "1.05"}}}};
  scene.solver = "chebyshev";
  scene.solver_parameters = {};
  auto world = make_solid_world(scene);
  const auto run = [&](int steps) {
    for (int k = 0; k < steps; ++k) EXPECT_TRUE(world->step());
    return particles_of(*world).x;
  };
  run(5);
  const Checkpoint checkpoint = world->save();
  const Positions once = run(5);
  world->load(checkpoint);
  EXPECT_EQ(run(5), once);
  // A reset forgets what chebyshev has learned, as a scene's start does.
  world->reset();
  auto fresh = make_solid_world(scene);
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(fresh->step());
  EXPECT_EQ(run(5), particles_of(*fresh).x);
}

TEST(TetrahedraEffects, RefuseBadParameters) {
  SolidScene scene = bar(true);
  const auto refuse = [&](const std::string& effect, const ParameterText& parameters,
                          const std::vector<std::string>& parts) {
    scene.effects = {{effect, parameters}};
    expect_refusal([&] { make_solid_world(scene); }, parts);
  };
  for (const char* bad : {"0", "-1", "nan", "inf"}) {
    refuse("volume", {{"stiffness", bad}}, {"stiffness"});
    refuse("volume", {{"min", bad}}, {"min"});
    refuse("volume", {{"max", bad}}, {"max"});
    refuse("strain_limit", {{"stiffness", bad}}, {"stiffness"});
    refuse("strain_limit", {{"min", bad}}, {"min"});
    refuse("strain_limit", {{"max", bad}}, {"max"});
  }
  refuse("volume", {{"min", "1.2"}, {"max", "1.1"}}, {"volume", "1.2 to 1.1", "min <= max"});
  refuse("strain_limit", {{"min", "1.1"}}, {"min"});
  refuse("strain_limit", {{"max", "0.9"}}, {"max"});
  refuse("volume", {{"stifness", "1"}}, {"stifness", "stiffness"});
}

}  // namespace
}  // namespace pliant
