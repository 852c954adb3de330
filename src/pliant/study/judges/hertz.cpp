// A rigid ball that is pressed into an elastic half-space, Hertz 1882:
//   F = 4/3 E/(1 - ν²) √R d^(3/2)
#include <cmath>

#include "pliant/core/world.h"
#include "pliant/effects/registry.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/models/patch/patch.h"
#include "pliant/models/solver_registry.h"
#include "pliant/study/judges/boussinesq.h"
#include "pliant/study/judges/judge.h"

namespace pliant {
namespace hertz {
namespace {

constexpr double kRadius = 0.05, kYoung = 2e4, kPoisson = 0.3;  // [m], [Pa]
constexpr double kDepth = 0.01 * kRadius;                       // [m]

/// Where the half-space ends here, in radii of the contact; beyond it moves as under a point force.
constexpr double kEnd = 4.0;

/// Cells of a seventh of the contact's radius in the middle, of half of it at the end.
double graded(double t) { return t * (0.35 + 0.65 * t * t); }

double hertz_force() {
  return 4.0 / 3.0 * kYoung / (1.0 - kPoisson * kPoisson) * std::sqrt(kRadius) *
         std::pow(kDepth, 1.5);
}

/// The block, 20 `cells` wide and half as deep; `outer` are those where it ends.
BodyGeometry half_space(int cells, std::vector<int>& outer) {
  const double contact = std::sqrt(kRadius * kDepth);
  TetrahedralMesh mesh = make_block({Eigen::Vector3d(2.0, 2.0, 1.0), {cells, cells, cells / 2}});
  std::vector<int> touched;
  for (int i = 0; i < mesh.vertices.cols(); ++i) {
    auto p = mesh.vertices.col(i);
    p.z() -= 0.5;
    const bool is_outer = p.head<2>().cwiseAbs().maxCoeff() > 1.0 - 1e-9 || p.z() < -1.0 + 1e-9;
    if (is_outer) outer.push_back(i);
    const bool is_top = p.z() > -1e-9;
    p = kEnd * contact * Eigen::Vector3d(graded(p.x()), graded(p.y()), graded(p.z()));
    if (is_top && p.norm() < 1.8 * contact) touched.push_back(i);
  }
  BodyGeometry geometry;
  geometry.mesh = {mesh.vertices, boundary_triangles(mesh)};
  geometry.contact_points = mesh.vertices(Eigen::all, touched);
  geometry.tetrahedra = std::move(mesh);
  return geometry;
}

double force_on_ball(int cells) {
  std::vector<int> outer;
  BodyGeometry geometry = half_space(cells, outer);
  const Positions rest = geometry.mesh.vertices;
  PatchModel::Material material;
  material.elastic = {kYoung, kPoisson, 500.0};
  // One step of 1 s from rest is a static solution.
  World world(1.0);
  Obstacle ball;
  ball.name = "ball";
  ball.shape = std::make_shared<Sphere>(kRadius);
  ball.pose_start = ball.pose_end =
      Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, kRadius - kDepth));
  world.add_obstacle(ball);
  Body& body =
      world.add_body("half-space", std::make_unique<PatchModel>(std::move(geometry), material));
  world.add_effect(body, effect_registry(), "contact", {{"thickness", "1e-6"}}, "judge");
  for (const int i : outer) {
    body.particles().x.col(i) += boussinesq(hertz_force(), kYoung, kPoisson, rest.col(i));
    body.particles().fix(i);
  }
  world.system_changed();
  world.set_solver(body, all_solvers(), "newton", {{"iterations", "20"}, {"tolerance", "1e-6"}},
                   "judge");
  world.set_initial_state();
  return world.step() ? world.reactions()[0].force.z() : std::nan("");
}

std::vector<JudgedFigure> judge_hertz(const JudgeOptions& options) {
  JudgedFigure force{"force at a depth of 1 % of the radius", "N", hertz_force()};
  force.coarser = force_on_ball(10);
  if (options.go_on(0.1)) force.ours = force_on_ball(20);
  return {force};
}

}  // namespace
}  // namespace hertz

Judge hertz_judge() {
  return {"hertz",
          "Hertz 1882 (J. reine angew. Math. 92), closed form",
          "rigid ball of 50 mm, E = 20 kPa, Poisson 0.3, 20,000 tetrahedra, seven cells along the "
          "radius of the contact",
          kComputed,
          false,
          hertz::judge_hertz};
}

}  // namespace pliant
