// Soft balls between plates: Hertz's law, and forces that balance.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/models/patch/patch.h"
#include "support/solvers/projective_model.h"
#include "support/worlds/patch_worlds.h"

namespace pliant::patch_press_test {
namespace {

constexpr double kRadius = 0.05;  // [m]
constexpr double kYoung = 2e4;    // [Pa]
constexpr double kPoisson = 0.3;

/// Fine near 0, coarse near 1, of t in [-1, 1].
double graded(double t) { return t * (0.2 + 0.8 * std::abs(t)); }

/// A ball of `cells`³ cells, small ones near its poles: a cube, graded and mapped.
BodyGeometry graded_ball(int cells) {
  TetrahedralMesh mesh = make_block({Eigen::Vector3d::Constant(2.0), {cells, cells, cells}});
  for (auto p : mesh.vertices.colwise()) {
    const double z = std::copysign(1.0 - graded(1.0 - std::abs(p.z())), p.z());
    const double x = graded(p.x()), y = graded(p.y()), x2 = x * x, y2 = y * y, z2 = z * z;
    p << x * std::sqrt(1.0 - y2 / 2.0 - z2 / 2.0 + y2 * z2 / 3.0),
        y * std::sqrt(1.0 - z2 / 2.0 - x2 / 2.0 + z2 * x2 / 3.0),
        z * std::sqrt(1.0 - x2 / 2.0 - y2 / 2.0 + x2 * y2 / 3.0);
  }
  mesh.vertices *= kRadius;
  BodyGeometry geometry;
  geometry.mesh = {mesh.vertices, boundary_triangles(mesh)};
  std::vector<Eigen::Vector3d> outside;
  for (const auto p : mesh.vertices.colwise()) {
    if (p.norm() > kRadius * (1.0 - 1e-9)) outside.emplace_back(p);
  }
  geometry.contact_points.resize(3, static_cast<Eigen::Index>(outside.size()));
  for (std::size_t k = 0; k < outside.size(); ++k) {
    geometry.contact_points.col(static_cast<Eigen::Index>(k)) = outside[k];
  }
  geometry.tetrahedra = std::move(mesh);
  return geometry;
}

struct Press {
  std::unique_ptr<World> world;
  double top = 0.0, bottom = 0.0;  ///< forces on the plates, outward [N]
};

/// A ball between two plates that go `depth` into it. One step of 1 s from rest is a static
/// solution: the ball rings within 10 ms.
Press press(int cells, double depth) {
  Press result;
  result.world = std::make_unique<World>(1.0);
  World& world = *result.world;
  const Eigen::AngleAxisd upside_down(3.14159265358979323846, Eigen::Vector3d::UnitX());
  world.add_obstacle(obstacle(Plane(), at(0, 0, depth - kRadius)));
  world.add_obstacle(obstacle(Plane(), at(0, 0, kRadius - depth) * upside_down));
  PatchModel::Material material;
  material.elastic = {kYoung, kPoisson, 500.0};
  Body& body = world.add_body("ball", std::make_unique<PatchModel>(graded_ball(cells), material));
  world.add_effect(body, effect_registry(), "contact", {{"thickness", "1e-6"}}, "test");
  world.set_solver(body, solver_registry(), "direct",
                   {{"iterations", "200"}, {"tolerance", "1e-6"}}, "test");
  world.set_initial_state();
  EXPECT_TRUE(world.step()) << world.failure();
  result.bottom = -world.reactions()[0].force.z();
  result.top = world.reactions()[1].force.z();
  return result;
}

TEST(PatchPress, PlatesCarryTheSameForce) {
  const Press pressed = press(8, 0.005);
  EXPECT_GT(pressed.top, 0.0);
  EXPECT_NEAR(pressed.top, pressed.bottom, 1e-3 * pressed.top);
  // What the plates feel is what the body pushes: no other force acts on it.
  const Body& body = body_of(*pressed.world);
  Forces elastic = Forces::Zero(3, body.particles().size());
  const auto& system = projective_system(*body.model);
  for (const auto& set : system.elements) set->add_forces(body.particles().x, elastic);
  double up = 0.0;
  for (int i = 0; i < elastic.cols(); ++i) up += std::max(0.0, elastic(2, i));
  EXPECT_GE(up, pressed.top * (1.0 - 1e-3));
}

TEST(PatchPress, HertzLaw) {
  // Each plate goes in by d: F = 4/3 E/(1 - ν²) √R d^(3/2), for small d/R.
  const double depth = 0.02 * kRadius;
  const Press pressed = press(20, depth);
  const double expected =
      4.0 / 3.0 * kYoung / (1.0 - kPoisson * kPoisson) * std::sqrt(kRadius) * std::pow(depth, 1.5);
  EXPECT_NEAR(pressed.top, expected, 0.1 * expected);
}

}  // namespace
}  // namespace pliant::patch_press_test
