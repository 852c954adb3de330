// A rigid ball that is pressed into an elastic half-space: the law of Hertz (1882).
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/models/patch/patch.h"
#include "pliant/study/judges/boussinesq.h"
#include "support/worlds/worlds.h"

namespace pliant::hertz_test {
namespace {

constexpr double kRadius = 0.05, kYoung = 2e4, kPoisson = 0.3;  // [m], [Pa]
constexpr double kStiffness = kYoung / (1.0 - kPoisson * kPoisson);

/// Where the half-space ends here, in radii of the contact; beyond it moves as under a point force.
constexpr double kEnd = 4.0;

/// Cells of a seventh of the contact's radius in the middle, of half of it at the end.
double graded(double t) { return t * (0.35 + 0.65 * t * t); }

class Hertz : public testing::TestWithParam<double> {};

TEST_P(Hertz, LawOfTheForceAtADepth) {
  const double depth = GetParam() * kRadius, contact = std::sqrt(kRadius * depth);
  const double expected = 4.0 / 3.0 * kStiffness * std::sqrt(kRadius) * std::pow(depth, 1.5);
  TetrahedralMesh mesh = make_block({Eigen::Vector3d(2.0, 2.0, 1.0), {20, 20, 10}});
  std::vector<int> outer, touched;
  for (int i = 0; i < mesh.vertices.cols(); ++i) {
    auto p = mesh.vertices.col(i);
    p.z() -= 0.5;
    const bool is_outer = p.head<2>().cwiseAbs().maxCoeff() > 1.0 - 1e-9 || p.z() < -1.0 + 1e-9;
    if (is_outer) outer.push_back(i);
    const bool is_top = p.z() > -1e-9;
    p = kEnd * contact * Eigen::Vector3d(graded(p.x()), graded(p.y()), graded(p.z()));
    if (is_top && p.norm() < 1.8 * contact) touched.push_back(i);
  }
  const Positions rest = mesh.vertices;
  BodyGeometry geometry;
  geometry.mesh = {rest, boundary_triangles(mesh)};
  geometry.contact_points = rest(Eigen::all, touched);
  geometry.tetrahedra = std::move(mesh);
  PatchModel::Material material;
  material.elastic = {kYoung, kPoisson, 500.0};

  // One step of 1 s from rest is a static solution.
  World world(1.0);
  world.add_obstacle(obstacle(Sphere(kRadius), at(0, 0, kRadius - depth)));
  Body& body =
      world.add_body("half-space", std::make_unique<PatchModel>(std::move(geometry), material));
  world.add_effect(body, effect_registry(), "contact", {{"thickness", "1e-6"}}, "test");
  Particles& particles = body.particles();
  for (const int i : outer) {
    particles.x.col(i) += boussinesq(expected, kYoung, kPoisson, rest.col(i));
    particles.fix(i);
  }
  world.system_changed();
  world.set_solver(body, solver_registry(), "newton", {{"iterations", "20"}, {"tolerance", "1e-6"}},
                   "test");
  world.set_initial_state();
  ASSERT_TRUE(world.step()) << world.failure();
  EXPECT_NEAR(world.reactions()[0].force.z(), expected, 0.05 * expected);
}

// Depth over the ball's radius; the contact's radius is 5, 10 and 20 % of that.
INSTANTIATE_TEST_SUITE_P(Depths, Hertz, testing::Values(0.0025, 0.01, 0.04), [](const auto& info) {
  return "radius_over_" + std::to_string(std::lround(1.0 / info.param));
});

}  // namespace
}  // namespace pliant::hertz_test
