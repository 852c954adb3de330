#include "support/disturb.h"
#include "support/solvers/stable_step.h"
#include "support/solvers/system_model.h"
#include "support/worlds/watched_run.h"

namespace pliant {
namespace {

class SmallestCloths : public EverySolver {
 protected:
  static std::unique_ptr<Model> single_triangle() {
    BodyGeometry geometry;
    geometry.mesh.vertices.resize(3, 3);
    geometry.mesh.vertices << 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0;
    geometry.mesh.triangles.resize(3, 1);
    geometry.mesh.triangles << 0, 1, 2;
    const auto& entry = model_registry().find("cloth");
    return entry.make(parse_parameters(entry.parameters, soft_material(), "test"), geometry);
  }
};

// Nothing acts from outside: momentum stays (with jacobi once it has converged).
TEST_P(SmallestCloths, OneTriangle) {
  const auto world = world_of(single_triangle(), 0.002, solver(), with_iterations(solver(), 2000));
  disturb(*world, 0.02, 0.2);
  const double start = world->energies().total();
  const Eigen::Vector3d momentum = particles_of(*world).momentum();
  EXPECT_LE(largest_energy(*world, 1.0), energy_swing(solver()) * start);
  EXPECT_TRUE(body_of(*world).report.warnings.empty());
  EXPECT_LT((particles_of(*world).momentum() - momentum).norm(), 1e-9 * momentum.norm());
}

TEST_P(SmallestCloths, TwoByTwoGrid) {
  ClothScene scene;
  scene.grid = {0.1, 0.1, 2, 2};
  scene.material = soft_material();
  scene.effects = {{"gravity", {}}};
  scene.fixed = {0};
  scene.solver = solver();
  scene.time_step = 0.5 * stable_step(scene);
  const auto world = make_world(scene);
  // It hangs by a corner. From its lowest place, a diagonal below, its energy at the start is:
  const double scale = particles_of(*world).mass.sum() * 9.81 * 0.1 * std::sqrt(2.0);
  EXPECT_LE(largest_energy(*world, 1.0), (energy_swing(solver()) - 1.0) * scale + 1e-12);
}

// Nothing is free: not a bit may change, and no division by the mobility may spoil it.
TEST_P(SmallestCloths, EveryVertexFixed) {
  ClothScene scene;
  scene.grid = {0.1, 0.1, 4, 4};
  scene.solver = solver();
  scene.obstacles = {obstacle(Plane())};
  scene.effects = {
      {"gravity", {}}, {"damping", {}}, {"air", {}}, {"contact", {}}, {"friction", {}}};
  for (int i = 0; i < 16; ++i) scene.fixed.push_back(i);
  for (double height : {0.0, 0.001, 0.0015, 0.1}) {
    scene.pose = at(0, 0, height);
    const auto world = make_world(scene);
    const Positions start = particles_of(*world).x;
    run_for(*world, 0.1);
    EXPECT_EQ(particles_of(*world).x, start) << height;
    EXPECT_TRUE(particles_of(*world).v.isZero(0.0)) << height;
    EXPECT_TRUE(world->reactions().front().force.allFinite()) << height;
  }
}

PLIANT_FOR_EVERY_SOLVER(SmallestCloths);

}  // namespace
}  // namespace pliant
