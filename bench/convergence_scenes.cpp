#include "convergence_scenes.h"

#include "pliant/effects/registry.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/models/cloth/cloth.h"
#include "support/solvers/system_model.h"
#include "support/worlds/solids.h"

namespace pliant::bench {
namespace {

constexpr double kStep = 1.0 / 100.0;  // [s]

struct ClothOptions {
  int side;
  double stretch;         // [N/m]
  double bending = 1e-5;  // [N m]
  double aspect = 1.0;    // of a cell
  bool on_ball = false;
};

/// A square cloth held at two corners that swings down, or one that falls on a ball.
std::unique_ptr<World> cloth(const ClothOptions& options) {
  auto world = std::make_unique<World>(kStep);
  if (options.on_ball) {
    Obstacle ball;
    ball.name = "ball";
    ball.shape = std::make_shared<Sphere>(0.2);
    ball.pose_start.translation().z() = ball.pose_end.translation().z() = -0.22;
    world->add_obstacle(ball);
  }
  BodyGeometry geometry;
  const int rows = std::max(2, static_cast<int>(options.side / options.aspect));
  geometry.grid = GridOptions{1.0, 1.0, options.side, rows};
  geometry.mesh = make_grid(*geometry.grid);
  ClothModel::Material material;
  material.stretch_warp = material.stretch_weft = options.stretch;
  material.shear = 0.1 * options.stretch;
  material.bending_warp = material.bending_weft = options.bending;
  Body& body = world->add_body("body", std::make_unique<ClothModel>(geometry, material));
  world->add_effect(body, effect_registry(), "gravity", {}, "bench");
  if (options.on_ball) {
    world->add_effect(body, effect_registry(), "contact", {}, "bench");
    world->add_effect(body, effect_registry(), "friction", {}, "bench");
  } else {
    body.particles().fix(0);
    body.particles().fix(options.side - 1);
  }
  return world;
}

struct SolidOptions {
  Eigen::Vector3i cells;
  double young;  // [Pa]
  double poisson = 0.3;
  double flatness = 1.0;  // height of a cell over its width
};

/// A beam of 0.4 m x 0.1 m x 0.1 m, held at one end, that sags.
std::unique_ptr<World> solid(const SolidOptions& options) {
  BlockOptions block;
  block.cells = options.cells;
  block.size = Eigen::Vector3d(0.4, 0.1, 0.1 * options.flatness);
  const TetrahedralMesh mesh = make_block(block);
  const Eigen::VectorXd masses = 1000.0 * vertex_volumes(mesh);
  auto model = std::make_unique<SystemModel>(mesh.vertices, masses);
  auto& system = static_cast<ProjectiveSystem&>(model->system());
  ElasticMaterial material;
  material.young = options.young;
  material.poisson = options.poisson;
  system.elements = make_solid(mesh, material);
  for (int i = 0; i < mesh.vertices.cols(); ++i) {
    if (on_face(mesh, i, 0, -1)) system.particles.fix(i);
  }
  auto world = std::make_unique<World>(kStep);
  Body& body = world->add_body("body", std::move(model));
  world->add_effect(body, effect_registry(), "gravity", {}, "bench");
  return world;
}

}  // namespace

std::vector<ConvergenceScene> convergence_scenes() {
  const auto a_cloth = [](const ClothOptions& o) { return [o] { return cloth(o); }; };
  const auto a_solid = [](const SolidOptions& o) { return [o] { return solid(o); }; };
  return {
      {"cloth 20x20, 50 N/m", a_cloth({20, 50.0})},
      {"cloth 50x50, 1 kN/m", a_cloth({50, 1e3})},
      {"cloth 50x50, 20 kN/m", a_cloth({50, 2e4})},
      {"cloth 100x100, 1 kN/m", a_cloth({100, 1e3})},
      {"cloth 64x8, cells 8:1", a_cloth({64, 1e3, 1e-5, 8.0})},
      {"cloth 30x30, bending 1 mN m", a_cloth({30, 1e3, 1e-3})},
      {"cloth 40x40 on a ball", a_cloth({40, 500.0, 1e-5, 1.0, true}), 12},
      {"beam 8x2x2, 10 kPa", a_solid({{8, 2, 2}, 1e4})},
      {"beam 16x4x4, 100 kPa", a_solid({{16, 4, 4}, 1e5})},
      {"beam 32x8x8, 1 MPa", a_solid({{32, 8, 8}, 1e6})},
      {"beam 16x4x4, slivers 1:10", a_solid({{16, 4, 4}, 1e5, 0.3, 0.1})},
      {"beam 16x4x4, Poisson 0.45", a_solid({{16, 4, 4}, 1e5, 0.45})},
  };
}

}  // namespace pliant::bench
