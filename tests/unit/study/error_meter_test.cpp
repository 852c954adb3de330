#include "pliant/study/accuracy/error_meter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/worlds.h"

namespace pliant {
namespace {

/// A sheet of 1 m x 1 m and 1 kg with a vertex of 0.25 kg in each corner but for the triangles'
/// shares: 1/6 kg at two of them, 1/3 kg at the two on the diagonal.
ClothScene square() {
  ClothScene scene;
  scene.grid = {1.0, 1.0, 2, 2};
  scene.material = {{"areal_density", "1"}};
  return scene;
}

TEST(ErrorMeter, WeighsDistancesByMass) {
  const auto world = make_world(square());
  const ErrorMeter meter(*world);
  EXPECT_DOUBLE_EQ(meter.size(), std::sqrt(2.0));
  const StateSample start = meter.sample(*world);
  std::vector<Positions> moved = start.positions;
  moved[0].col(0) += Eigen::Vector3d(0, 3, 4);
  const double mass = particles_of(*world).mass[0];
  EXPECT_DOUBLE_EQ(meter.distance(start.positions, moved), std::sqrt(25.0 * mass));
  moved[0] = start.positions[0].colwise() + Eigen::Vector3d(0, 0, 2);
  EXPECT_DOUBLE_EQ(meter.distance(start.positions, moved), 2.0);
}

TEST(ErrorMeter, StrainIsThatOfTheWorstEdge) {
  const auto world = make_world(square());
  const ErrorMeter meter(*world);
  EXPECT_EQ(meter.sample(*world).largest_strain, 0.0);
  particles_of(*world).x.row(0) *= 1.5;
  EXPECT_NEAR(meter.sample(*world).largest_strain, 0.5, 1e-15);
  particles_of(*world).x.row(0) *= 0.2 / 1.5;
  EXPECT_NEAR(meter.sample(*world).largest_strain, 0.8, 1e-15);
}

TEST(ErrorMeter, ErrorsAreSharesOfTheScale) {
  const auto world = make_world(square());
  const ErrorMeter meter(*world);
  const StateSample start = meter.sample(*world);
  StateSample reference = start, state = start;
  reference.positions[0].row(2).array() += 2.0;
  reference.energies = {3.0, 1.0, -6.0};  // of which 6 J fell
  reference.largest_strain = 0.10;
  state.positions[0].row(2).array() += 2.5;
  state.energies = {3.5, 1.5, -6.0};
  state.largest_strain = 0.13;
  const ErrorScale scale = meter.scale(start.positions, reference);
  EXPECT_DOUBLE_EQ(scale.distance, 2.0);
  EXPECT_DOUBLE_EQ(scale.energy, 10.0);
  const Errors errors = meter.errors(state, reference, scale);
  EXPECT_DOUBLE_EQ(errors.rms, 0.5);
  EXPECT_DOUBLE_EQ(errors.largest, 0.5);
  EXPECT_DOUBLE_EQ(errors.position, 0.25);
  EXPECT_DOUBLE_EQ(errors.energy, 0.1);
  EXPECT_NEAR(errors.strain, 0.03, 1e-15);
}

TEST(ErrorMeter, DividesByNoZero) {
  const auto world = make_world(square());
  const ErrorMeter meter(*world);
  const StateSample start = meter.sample(*world);
  const ErrorScale scale = meter.scale(start.positions, start);
  EXPECT_DOUBLE_EQ(scale.distance, 1e-9 * std::sqrt(2.0));
  EXPECT_NEAR(scale.energy, 1e-9 * 0.5 * 2.0, 1e-15);
  const Errors errors = meter.errors(start, start, scale);
  EXPECT_EQ(errors.position, 0.0);
  EXPECT_EQ(errors.energy, 0.0);
  const World empty(0.1);
  const ErrorMeter none(empty);
  const StateSample nothing = none.sample(empty);
  EXPECT_EQ(none.errors(nothing, nothing, none.scale({}, nothing)).position, 0.0);
}

TEST(ErrorMeter, WhatIsNotFiniteIsInfinitelyWrong) {
  const auto world = make_world(square());
  const ErrorMeter meter(*world);
  const StateSample start = meter.sample(*world);
  StateSample bad = start;
  bad.positions[0](1, 2) = std::nan("");
  bad.energies.kinetic = std::nan("");
  bad.largest_strain = std::nan("");
  const Errors errors = meter.errors(bad, start, {1.0, 1.0});
  for (double error : {errors.position, errors.rms, errors.largest, errors.energy, errors.strain}) {
    EXPECT_TRUE(std::isinf(error));
  }
}

TEST(ErrorMeter, SeveralBodiesCountTogether) {
  auto world = make_world(square());
  const auto& entry = model_registry().find("cloth");
  BodyGeometry geometry{make_grid({1.0, 1.0, 2, 2}), GridOptions{1.0, 1.0, 2, 2}};
  world->add_body(
      "heavy",
      entry.make(parse_parameters(entry.parameters, {{"areal_density", "3"}}, "test"), geometry));
  const ErrorMeter meter(*world);
  const StateSample start = meter.sample(*world);
  std::vector<Positions> moved = start.positions;
  moved[1].row(0).array() += 2.0;  // 3 of 4 kg by 2 m
  EXPECT_DOUBLE_EQ(meter.distance(start.positions, moved), std::sqrt(3.0));
}

TEST(Extrapolated, TakesTheFirstOrderAway) {
  StateSample fine, coarse;
  fine.positions = {Positions::Constant(3, 2, 1.25)};  // 1 + 0.25
  coarse.positions = {Positions::Constant(3, 2, 1.5)};
  fine.energies = {2.1, 3.2, 4.3};
  coarse.energies = {2.2, 3.4, 4.6};
  fine.largest_strain = 0.11;
  coarse.largest_strain = 0.12;
  const StateSample limit = extrapolated(fine, coarse);
  EXPECT_EQ(limit.positions[0], Positions::Ones(3, 2));
  EXPECT_NEAR(limit.energies.kinetic, 2.0, 1e-14);
  EXPECT_NEAR(limit.energies.elastic, 3.0, 1e-14);
  EXPECT_NEAR(limit.energies.potential, 4.0, 1e-14);
  EXPECT_NEAR(limit.largest_strain, 0.1, 1e-15);
}

TEST(InertialPrediction, IsTheStepOfAFreeBody) {
  ClothScene scene = square();
  scene.effects = {{"gravity", {}}};
  scene.solver = "jacobi";
  auto world = make_world(scene);
  particles_of(*world).v.row(0).setConstant(2.0);
  ASSERT_TRUE(world->step());
  // Nothing strains it, so that the step is the prediction.
  EXPECT_LT((inertial_prediction(*world)[0] - particles_of(*world).x).norm(), 1e-12);
  const double h = scene.time_step;
  EXPECT_NEAR(inertial_prediction(*world)[0](0, 0), particles_of(*world).x_start(0, 0) + 2.0 * h,
              1e-15);
  EXPECT_NEAR(inertial_prediction(*world)[0](2, 0), -9.81 * h * h, 1e-15);
}

TEST(InertialPrediction, FixedVerticesStay) {
  ClothScene scene = square();
  scene.effects = {{"gravity", {}}};
  scene.fixed = {1};
  auto world = make_world(scene);
  const Positions start = particles_of(*world).x;
  ASSERT_TRUE(world->step());
  EXPECT_EQ(inertial_prediction(*world)[0].col(1), start.col(1));
}

}  // namespace
}  // namespace pliant
