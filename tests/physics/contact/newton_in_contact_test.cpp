// Newton's method with contact and friction in its linear equations comes to the end within few
// iterations, where a sheet slides over bodies and where solids lie on each other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/scene.h"
#include "unit/scene/scene_files.h"

namespace pliant::newton_in_contact_test {
namespace {

constexpr const char* kClothOverJelly = R"(
time_step: 0.005
gravity: [0, 0, -9.81]
bodies:
  - name: jelly
    model: patch
    geometry: {sphere: {radius: 0.05}, tetrahedra: 300, surface_level: 4}
    position: [-0.06, 0, 0.052]
    material: {young: 5.0e+4, poisson: 0.3, density: 500}
  - name: towel
    model: cloth
    geometry: {grid: {size: [0.32, 0.12], vertices: [27, 11]}}
    position: [0, 0, 0.115]
    material: {areal_density: 0.2, stretch_warp: 500, stretch_weft: 500, shear: 50, bending: 2.0e-5}
obstacles:
  - {name: box, shape: box, size: [0.07, 0.09, 0.06], position: [0.075, 0, 0.032]}
  - {name: table, shape: plane}
effects:
  damping: {rate: 1.0}
  contact: {thickness: 0.002}
  friction: {coefficient: 0.5}
  body_contact: {thickness: 0.002, friction: 0.4}
)";

constexpr const char* kSolids = R"(
time_step: 0.005
gravity: [0, 0, -9.81]
bodies:
  - name: torus
    model: patch
    geometry: {torus: {ring: 0.06, tube: 0.025}, tetrahedra: 800}
    position: [0, 0, 0.026]
    material: {young: 3.0e+4, poisson: 0.35, density: 500}
  - name: ball
    model: patch
    geometry: {sphere: {radius: 0.035}, tetrahedra: 300}
    position: [0.005, 0, 0.075]
    material: {young: 2.0e+4, poisson: 0.3, density: 400}
obstacles:
  - {name: table, shape: plane}
effects:
  damping: {rate: 1.0}
  contact: {thickness: 0.001}
  friction: {coefficient: 0.5}
  self_contact: {thickness: 0.002}
)";

// Bodies of a kilogramme, and cloth of a gram and a half on one of them.
constexpr const char* kRigid = R"(
time_step: 0.005
gravity: [0, 0, -9.81]
bodies:
  - name: tray
    model: rigid
    geometry: {box: {size: [0.3, 0.2, 0.012]}}
    position: [0, 0, 0.0095]
    material: {density: 900}
    velocity: [0.3, 0, 0]
  - name: can
    model: rigid
    geometry: {cylinder: {radius: 0.03, length: 0.09}}
    position: [0.09, -0.03, 0.064]
    material: {density: 900}
  - name: napkin
    model: cloth
    geometry: {grid: {size: [0.12, 0.12], vertices: [11, 11]}}
    position: [-0.05, 0.03, 0.019]
    material: {areal_density: 0.1, stretch_warp: 300, stretch_weft: 300, shear: 30, bending: 1.0e-5}
obstacles:
  - {name: table, shape: plane}
effects:
  damping: {rate: 1.0}
  contact: {thickness: 0.002}
  friction: {coefficient: 0.5}
  body_contact: {thickness: 0.002, friction: 0.5}
)";

struct Case {
  const char* name;
  const char* scene;
  double tolerance, linear_tolerance;
  int most;         // iterations of a step that is typical: 9 in 10 steps take no more
  int most_of_any;  // of any step
};

class NewtonInContact : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(Scenes, NewtonInContact,
                         testing::Values(Case{"ClothRoughly", kClothOverJelly, 1e-2, 0.03, 8, 16},
                                         Case{"ClothFinely", kClothOverJelly, 1e-6, 1e-4, 12, 30},
                                         Case{"SolidsRoughly", kSolids, 1e-2, 0.03, 6, 12},
                                         Case{"SolidsFinely", kSolids, 1e-6, 1e-4, 10, 20},
                                         Case{"RigidRoughly", kRigid, 1e-2, 0.03, 8, 16}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(NewtonInContact, Converges) {
  const Case& c = GetParam();
  SceneFiles files;
  const std::string solver = fmt::format(
      "solver: {{name: newton, iterations: 200, tolerance: {}, linear_tolerance: {}}}\n",
      c.tolerance, c.linear_tolerance);
  const std::unique_ptr<World> world =
      build_world(read_scene(files.write("scene.yaml", c.scene + solver)));
  std::vector<int> iterations;
  double largest = 0.0;
  for (int step = 0; step < 80; ++step) {
    ASSERT_TRUE(world->step()) << world->failure();
    iterations.push_back(world->bodies().front().report.iterations);
    largest = std::max(largest, world->bodies().front().report.residual);
  }
  std::sort(iterations.begin(), iterations.end());
  EXPECT_LE(iterations[71], c.most);
  EXPECT_LE(iterations.back(), c.most_of_any);
  EXPECT_GE(iterations.back(), 3) << "nothing touched";
  EXPECT_LE(largest, c.tolerance);
}

// The cloth's error is not lost among the forces of bodies a thousand times as heavy.
TEST(NewtonInContact, LightClothOnHeavyBodiesIsAsExact) {
  SceneFiles files;
  const std::unique_ptr<World> world = build_world(read_scene(files.write(
      "scene.yaml", std::string(kRigid) + "solver: {name: newton, iterations: 20, tolerance: 0.03, "
                                          "linear_tolerance: 0.03}\n")));
  double most = 0.0;
  for (int step = 0; step < 80; ++step) {
    ASSERT_TRUE(world->step()) << world->failure();
    for (const auto& body : world->bodies()) {
      most = std::max(most, body.report.error.value_or(0.0));
      EXPECT_TRUE(body.report.warnings.empty()) << step << ": " << body.report.warnings.front();
    }
  }
  EXPECT_GT(most, 0.0) << "not estimated";
  EXPECT_LE(most, 0.05);
}

}  // namespace
}  // namespace pliant::newton_in_contact_test
