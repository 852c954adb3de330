// Reduced bodies in scene files.
#include <gtest/gtest.h>

#include "pliant/models/reduced/files/example_bodies.h"
#include "pliant/models/reduced/files/reduced_file.h"
#include "pliant/models/reduced/reduced_body.h"
#include "pliant/scene/scene.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

constexpr const char* kScene = R"(time_step: 0.003
bodies:
  - name: beam
    model: reduced
    geometry: {example: {name: beam, scale: 0.1, young: 1e5, density: 500, modes: 3, rank: 6}}
    material: {alpha: 0.5, beta: 1e-3, fast_frequency: 20}
    position: [0, 0, 1]
    rotation_rpy: [0, 0, 1.5707963267948966]
    velocity: [0, 0, 0.1]
effects:
  gravity: {acceleration: [0, 0, -9.81]}
solver: {name: trigonometric, exact: 2}
)";

const ReducedBodySystem& system_of(const World& world) {
  return dynamic_cast<const ReducedBodySystem&>(world.bodies().front().model->system());
}

TEST(ReducedScene, MakesAnExample) {
  const SceneFiles files;
  const LoadedScene scene = load_scene(files.write("scene.yaml", kScene));
  const ReducedBodySystem& system = system_of(*scene.world);
  EXPECT_EQ(system.q.size(), 6);
  EXPECT_EQ(system.damping.mass, 0.5);
  EXPECT_EQ(system.damping.stiffness, 1e-3);
  EXPECT_GT(system.p.norm(), 0.0);
  // 0.1 m by 0.012 m by 0.008 m, turned to lie along y.
  EXPECT_NEAR(system.particles.mass.sum(), 500.0 * 0.1 * 0.012 * 0.008, 1e-12);
  EXPECT_NEAR(system.particles.x.row(1).maxCoeff(), 0.1, 1e-12);
  EXPECT_NEAR(system.particles.x.row(0).maxCoeff(), 0.006, 1e-12);
  EXPECT_NEAR(system.particles.x.row(2).maxCoeff(), 1.004, 1e-12);
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(scene.world->step());
  EXPECT_EQ(scene.world->bodies().front().report.solver, "trigonometric");
}

TEST(ReducedScene, FrequenciesGoAsTheSquareRootOfStiffnessOverDensityAndSize) {
  const SceneFiles files;
  // All that three modes and their six derivatives span, so that the size chooses nothing.
  const std::string text = replaced(kScene, "rank: 6", "rank: 9");
  const LoadedScene small = load_scene(files.write("small.yaml", text));
  const LoadedScene large =
      load_scene(files.write("large.yaml", replaced(replaced(text, "scale: 0.1", "scale: 0.2"),
                                                    "young: 1e5", "young: 9e5")));
  const auto& slow = system_of(*small.world).potential.lambda();
  const auto& fast = system_of(*large.world).potential.lambda();
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(fast[i] / slow[i], 9.0 / 4.0, 1e-6);
}

TEST(ReducedScene, ReadsAFileOfPliantReduce) {
  const SceneFiles files;
  const LoadedScene made = load_scene(files.write("scene.yaml", kScene));
  ExampleBody example = example_body("beam");
  const StvkBody body(example.mesh, example.material, example.fixed, "beam");
  write_reduced_model(
      files.path("beam.prm"),
      *reduce(body, {3, 6}, "beam", [](double, double, const std::string&) { return true; }));
  const std::string text = replaced(
      kScene, "{example: {name: beam, scale: 0.1, young: 1e5, density: 500, modes: 3, rank: 6}}",
      "{reduced_model: beam.prm, contact_spacing: 0.05}");
  const LoadedScene scene = load_scene(files.write("file.yaml", text));
  EXPECT_EQ(system_of(*scene.world).q.size(), 6);
  EXPECT_EQ(system_of(*scene.world).particles.size(), example.mesh.vertices.cols());
  // A point each 5 cm of the surface, and not more than its neighbours' half.
  EXPECT_GT(system_of(*scene.world).touching().size(), 100);
  EXPECT_TRUE(scene.world->step());
  files.write("beam.prm", "no model");
  expect_refusal([&] { load_scene(files.path("file.yaml")); }, {"file.yaml:5", "beam.prm"});
}

TEST(ReducedScene, DrawsAndTouchesWithTheSurfaceThatItsTetrahedraCarry) {
  const SceneFiles files;
  const std::string text =
      replaced(replaced(kScene, "{name: beam, scale: 0.1, young: 1e5, density: 500, modes: 3",
                        "{name: soft_heart, scale: 0.5, modes: 3"),
               "    velocity: [0, 0, 0.1]\n", "");
  const LoadedScene scene = load_scene(files.write("scene.yaml", text));
  Model& model = *scene.world->bodies().front().model;
  const TriangleMesh rest = model.surface();
  EXPECT_TRUE(boundary_vertices(rest).empty());
  EXPECT_GT(rest.vertices.cols(), 2 * model.particles().size()) << "finer than the tetrahedra";
  EXPECT_NEAR(rest.vertices.row(1).maxCoeff() - rest.vertices.row(1).minCoeff(), 0.0342, 0.2e-3)
      << "half of 68.4 mm, turned to lie along y";
  EXPECT_EQ(model.on_surface(Eigen::VectorXd::Ones(model.particles().size())).size(),
            rest.vertices.cols());
  // It moves as its tetrahedra do, by the same weights.
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(scene.world->step());
  const EmbeddedPoints& points = *model.surface_points();
  Eigen::Matrix3Xd carried(3, points.size());
  points.positions(model.particles().x, carried);
  EXPECT_EQ(model.surface().vertices, carried);
  EXPECT_GT((carried - rest.vertices).colwise().norm().maxCoeff(), 1e-5);
}

struct ReducedCase {
  const char* from;
  const char* to;
  std::vector<std::string> parts;
};

std::ostream& operator<<(std::ostream& stream, const ReducedCase& given) {
  return stream << given.from << " -> " << given.to;
}

class ReducedSceneRefusal : public testing::TestWithParam<ReducedCase> {};

TEST_P(ReducedSceneRefusal, SaysWhatAndWhere) {
  const SceneFiles files;
  const std::string path =
      files.write("scene.yaml", replaced(kScene, GetParam().from, GetParam().to));
  expect_refusal([&] { load_scene(path); }, GetParam().parts);
}

INSTANTIATE_TEST_SUITE_P(
    All, ReducedSceneRefusal,
    testing::Values(
        ReducedCase{"    velocity",
                    "    fixed: [{vertices: [0]}]\n    velocity",
                    {"scene.yaml:9", "fixed", "pliant reduce --fix"}},
        ReducedCase{
            "name: beam, scale", "name: beem, scale", {"scene.yaml:5", "did you mean 'beam'"}},
        ReducedCase{"name: beam, scale", "scale", {"scene.yaml:5", "name"}},
        ReducedCase{"scale: 0.1", "scale: 0", {"scene.yaml:5", "scale", "> 0"}},
        ReducedCase{"rank: 6", "rank: 40", {"scene.yaml:5", "rank is 40"}},
        ReducedCase{"rank: 6", "ranks: 6", {"scene.yaml:5", "did you mean 'rank'"}},
        ReducedCase{"{example:", "{exmple:", {"scene.yaml:5", "reduced_model, example"}},
        ReducedCase{
            "{example: {name: beam, scale: 0.1, young: 1e5, density: 500, modes: 3, rank: 6}}",
            "{sphere: {radius: 1}}",
            {"scene.yaml:5", "'sphere' does not work for model 'reduced'", "example"}},
        ReducedCase{"alpha: 0.5", "alpha: -0.5", {"scene.yaml:6", "alpha", ">= 0"}},
        ReducedCase{"name: trigonometric, exact: 2",
                    "name: xpbd",
                    {"scene.yaml:12", "model 'reduced'", "trigonometric"}},
        ReducedCase{"name: trigonometric, exact: 2",
                    "name: trigonometrc",
                    {"scene.yaml:12", "did you mean 'trigonometric'"}},
        ReducedCase{"name: trigonometric, exact: 2",
                    "name: imex",
                    {"scene.yaml:12", "'trigonometric' took its place", "'imex_thesis'"}},
        ReducedCase{"  gravity: {acceleration: [0, 0, -9.81]}",
                    "  air: {}",
                    {"scene.yaml:11", "'air' does not work for model 'reduced'"}}));

}  // namespace
}  // namespace pliant
