// Wet layers of cloth hold on to each other.
#include <gtest/gtest.h>

#include "pliant/effects/wetness/wetness.h"
#include "pliant/geometry/mesh/grid.h"
#include "support/measures.h"
#include "support/worlds/sheets.h"

namespace pliant::wet_layers_test {
namespace {

constexpr double kWidth = 0.1, kThickness = 0.002, kRange = 0.001;  // [m]
constexpr double kDry = 0.15, kWater = 0.2;                         // [kg/m²]
constexpr int kSide = 6;
constexpr double kTop = 0.2;  // [m]

/// Two sheets, the second below the first.
TriangleMesh two_layers() {
  const TriangleMesh one = make_grid({kWidth, kWidth, kSide, kSide});
  const Eigen::Index n = one.vertices.cols(), m = one.triangles.cols();
  TriangleMesh both{Eigen::Matrix3Xd(3, 2 * n), Eigen::Matrix3Xi(3, 2 * m)};
  both.vertices << one.vertices, one.vertices;
  both.vertices.row(2).head(n).array() += kTop;
  both.vertices.row(2).tail(n).array() += kTop - kThickness;
  both.triangles << one.triangles, one.triangles.array() + static_cast<int>(n);
  return both;
}

/// The upper one is held; water may carry `share` of what the lower one weighs.
std::unique_ptr<World> hanging(double share, const std::string& wetness, const char* friction) {
  const double w = std::stod(wetness);
  const double adhesion = share * 9.81 * (kDry + w * kWater) / w;
  auto world = sheet_world(
      two_layers(), {},
      {{"gravity", {}},
       {"self_contact", {{"thickness", std::to_string(kThickness)}, {"friction", friction}}},
       {"wetness",
        {{"wetness", wetness},
         {"capacity", std::to_string(kWater)},
         {"adhesion", std::to_string(adhesion)},
         {"adhesion_range", std::to_string(kRange)}}}},
      0.005, {{"areal_density", std::to_string(kDry)}});
  for (int i = 0; i < kSide * kSide; ++i) particles_of(*world).fix(i);
  world->system_changed();
  return world;
}

// Each of both layers' vertices brings half.
TEST(WetLayers, HoldWhatTheAdhesionCarriesAndNoMore) {
  for (const char* wetness : {"1", "0.5"}) {
    const auto holding = hanging(1.05, wetness, "0.5"), falling = hanging(0.95, wetness, "0.5");
    run_for(*holding, 0.5);
    run_for(*falling, 0.5);
    EXPECT_GT(lowest(*holding), kTop - kThickness - kRange) << wetness;
    EXPECT_LT(lowest(*falling), kTop - 0.5) << wetness;
  }
}

TEST(WetLayers, DryOnesDoNot) {
  auto world = hanging(2.0, "1", "0.5");
  Body& body = body_of(*world);
  for (SettableField& field : body.find_effect("wetness")->settable_fields()) {
    for (int i = 0; i < particles_of(*world).size(); ++i) field.set(i, 0.0);
  }
  run_for(*world, 0.2);
  EXPECT_LT(lowest(*world), kTop - 0.1);
}

// Pulled sideways they hold by friction on what the water pulls, though nothing presses them.
TEST(WetLayers, RubWithWhatTheWaterPulls) {
  for (const char* friction : {"0", "0.5"}) {
    auto world = hanging(4.0, "1", friction);
    AppliedForce force;
    force.force.x() = 0.5 * 9.81 * (kDry + kWater) * kWidth * kWidth;  // a quarter of the pull
    force.radius = 1.0;
    force.duration = -1.0;
    world->applied_forces().add(force);
    run_for(*world, 0.2);
    const double displacement = particles_of(*world).x.row(0).maxCoeff() - 0.5 * kWidth;
    if (std::stod(friction) > 0.0) {
      EXPECT_LT(displacement, 1e-3);
    } else {
      EXPECT_GT(displacement, 0.01);
    }
  }
}

}  // namespace
}  // namespace pliant::wet_layers_test
