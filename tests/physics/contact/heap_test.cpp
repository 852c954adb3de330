// Smooth bodies that fall onto each other, roll and come to rest: contact takes energy, never
// gives any.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pliant/effects/self_contact/self_contact_parts.h"
#include "pliant/scene/scene.h"
#include "support/meshes/overlap.h"
#include "support/solvers/solvers.h"
#include "unit/scene/scene_files.h"

namespace pliant::heap_test {
namespace {

constexpr double kThickness = 0.002;  // [m]

/// A ball in the hole of a torus, and another one that falls on both and rolls off.
std::string heap(const std::string& solver) {
  return fmt::format(R"(
time_step: 0.005
bodies:
  - name: torus
    model: patch
    geometry: {{torus: {{ring: 0.06, tube: 0.025}}, tetrahedra: 800}}
    position: [0, 0, 0.028]
    material: {{young: 3.0e+4, poisson: 0.35, density: 500}}
  - name: lower
    model: patch
    geometry: {{sphere: {{radius: 0.035}}, tetrahedra: 300}}
    position: [0.005, 0, 0.075]
    material: {{young: 2.0e+4, poisson: 0.3, density: 400}}
  - name: upper
    model: patch
    geometry: {{sphere: {{radius: 0.035}}, tetrahedra: 300}}
    position: [0.009, 0.002, 0.15]
    material: {{young: 2.0e+4, poisson: 0.3, density: 400}}
obstacles:
  - {{name: table, shape: plane, friction: 0.5}}
effects:
  gravity: {{acceleration: [0, 0, -9.81]}}
  contact: {{thickness: 0.001}}
  friction: {{}}
  self_contact: {{thickness: {}}}
solver: {{name: {}}}
)",
                     kThickness, solver);
}

class Heap : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Solvers, Heap, testing::Values("chebyshev", "direct"), test_name_of);

/// The deepest that a point of one body's surface lies within the tetrahedra of another one [m].
double deepest_overlap(const Model& model) {
  const TetrahedralMesh& rest = *model.tetrahedra();
  const SelfContactParts parts(rest, model.surface_triangles(), model.surface_points(),
                               model.contact_points());
  const Positions& x = model.particles().x;
  double deepest = -INFINITY;
  for (int part = 0; part < 3; ++part) {
    Eigen::Matrix4Xi own(4, 0);
    for (const auto t : rest.tetrahedra.colwise()) {
      if (parts.part_of_particle(t[0]) != part) continue;
      own.conservativeResize(4, own.cols() + 1);
      own.rightCols(1) = t;
    }
    for (int i = 0; i < parts.points().size(); i += 7) {
      if (parts.part_of_point(i) == part) continue;
      deepest = std::max(deepest, depth_within(parts.points().position(x, i), x, own));
    }
  }
  return deepest;
}

TEST_P(Heap, TakesEnergyAndStaysOutOfItself) {
  SceneFiles files;
  const std::unique_ptr<World> world =
      build_world(read_scene(files.write("heap.yaml", heap(GetParam()))));
  ASSERT_EQ(world->bodies().size(), 1u) << "bodies that touch are one system";
  const Body& body = world->bodies().front();
  // Contact may push what is nearer than the thickness: mg times that.
  const double weight = 9.81 * body.particles().mass.sum();
  double total = world->energies().total();
  for (int step = 0; step < 80; ++step) {
    ASSERT_TRUE(world->step()) << world->failure();
    const double now = world->energies().total();
    EXPECT_LE(now, total + kThickness * weight) << "step " << step;
    total = std::min(total, now);
  }
  EXPECT_GT(deepest_overlap(*body.model), -2.0 * kThickness) << "nothing lies on anything";
  EXPECT_LE(deepest_overlap(*body.model), 0.0);
}

}  // namespace
}  // namespace pliant::heap_test
