#include "pliant/models/patch/patch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/elements/solids/fiber_set.h"
#include "pliant/math/pi.h"
#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/solvers/projective_model.h"
#include "support/worlds/patch_worlds.h"

namespace pliant {
namespace {

TEST(PatchModel, WeighsItsVolume) {
  PatchScene scene;
  scene.options = {{"tetrahedra", "8000"}};
  const auto model = make_patch_model(scene);
  const double volume = 4.0 / 3.0 * kPi * 1.25e-4, mass = 500.0 * volume;
  // Flat faces leave out what lies between them and the ball: chords as long as a cell's diagonal
  // √3 c lie 3 c²/(8 r) deep, together less than 9/8 (c/r)² of the volume.
  const double cell = std::cbrt(12.0 * volume / 8000.0);
  EXPECT_NEAR(model->particles().mass.sum(), mass, 9.0 / 8.0 * std::pow(cell / 0.05, 2.0) * mass);
  EXPECT_LT(model->particles().mass.sum(), mass);
}

TEST(PatchModel, HasTheElementsItsMaterialCallsFor) {
  PatchScene scene;
  EXPECT_EQ(projective_system(*make_patch_model(scene)).elements.size(), 1u);
  scene.material["fiber_stiffness"] = "1e4";
  const auto model = make_patch_model(scene);
  ASSERT_EQ(projective_system(*model).elements.size(), 2u);
  EXPECT_NE(dynamic_cast<const FiberSet*>(projective_system(*model).elements[1].get()), nullptr);
}

TEST(PatchModel, ManyJoinedOnesKeepTheirRestShapesToRoundOff) {
  PatchScene scene;
  scene.options = {{"tetrahedra", "100"}};
  const auto model = make_patch_model(scene);
  const TetrahedralMesh alone = *model->tetrahedra();
  const Eigen::Index count = alone.vertices.cols();
  constexpr int kBodies = 60;
  for (int b = 1; b < kBodies; ++b) ASSERT_TRUE(model->join(*make_patch_model(scene)));
  const TetrahedralMesh& all = *model->tetrahedra();
  EXPECT_NO_THROW(validate(all, "joined"));
  double before = -1e9;
  for (int b = 0; b < kBodies; ++b) {
    const Eigen::Matrix3Xd own = all.vertices.middleCols(b * count, count);
    const Eigen::Vector3d shift = own.col(0) - alone.vertices.col(0);
    const Eigen::Matrix3Xd expected = alone.vertices.colwise() + shift;
    EXPECT_LT((own - expected).cwiseAbs().maxCoeff(), 1e-14) << "body " << b;
    EXPECT_GT(own.row(0).minCoeff(), before + 0.05) << "body " << b << " touches the one before";
    before = own.row(0).maxCoeff();
  }
}

TEST(PatchModel, ItsSurfaceIsTheShapeAndFollowsTheParticles) {
  const auto model = make_patch_model(PatchScene());
  const Eigen::Matrix3Xd rest = model->surface().vertices;
  ASSERT_EQ(rest.cols(), model->surface_vertices());
  // The shape of patches is a sphere to 6e-5 of its radius, whatever its tetrahedra are.
  EXPECT_NEAR(rest.colwise().norm().maxCoeff(), 0.05, 0.05 * 1e-4);
  EXPECT_NEAR(rest.colwise().norm().minCoeff(), 0.05, 0.05 * 1e-4);
  Random random(3);
  const Eigen::Matrix3d map = Eigen::Matrix3d::Identity() + 0.3 * random.positions(3, 1.0);
  const Eigen::Vector3d shift = random.vector(1.0);
  Particles& particles = model->particles();
  particles.x = ((map * particles.x).colwise() + shift).eval();
  const Eigen::Matrix3Xd expected = (map * rest).colwise() + shift;
  EXPECT_LT((model->surface().vertices - expected).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(PatchModel, ItsSurfaceStaysClosedHoweverItIsDeformed) {
  const auto model = make_patch_model(PatchScene());
  Random random(8);
  model->particles().x = random.positions(model->particles().size(), 1.0);
  TriangleMesh surface = model->surface();
  // Vertices are shared, so that each edge has two triangles and no gap at all.
  EXPECT_NO_THROW(validate(surface, "surface"));
  EXPECT_TRUE(boundary_vertices(surface).empty());
}

TEST(PatchModel, ContactPointsLieOnTheSurface) {
  const auto model = make_patch_model(PatchScene());
  Eigen::Matrix3Xd points(3, model->contact_points()->size());
  model->contact_points()->positions(model->particles().x, points);
  EXPECT_GT(points.cols(), 100);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    EXPECT_NEAR(points.col(i).norm(), 0.05, 0.05 * 1e-4);
  }
}

TEST(PatchModel, FieldsOfAStretchedBody) {
  PatchScene scene;
  const auto model = make_patch_model(scene);
  model->particles().x.row(0) *= 1.1;
  const auto fields = model->point_fields();
  ASSERT_EQ(fields.size(), 3u);
  EXPECT_NEAR(fields.at("strain").maxCoeff(), 0.1, 1e-12);
  EXPECT_NEAR(fields.at("strain").minCoeff(), 0.1, 1e-12);
  EXPECT_NEAR(fields.at("volume").maxCoeff(), 1.1, 1e-12);
  // Uniaxial strain: the principal stresses differ by 2 μ ε.
  const double mu = 2e4 / 2.6;
  EXPECT_NEAR(fields.at("von_mises").minCoeff(), 2.0 * mu * 0.1, 1e-8);
}

TEST(PatchModel, JoinsOthersOfItsKind) {
  PatchScene scene;
  const auto first = make_patch_model(scene);
  scene.kind = "block";
  scene.size = {{"size", "[0.1, 0.1, 0.1]"}, {"cells", "[2, 2, 2]"}};
  scene.options = {};
  const auto second = make_patch_model(scene);
  second->particles().x.row(0).array() += 0.2;
  second->particles().fix(4);
  const int n = first->particles().size(), m = second->particles().size();
  const double mass = first->particles().mass.sum() + second->particles().mass.sum();
  const TriangleMesh surface = second->surface();
  const int offset = first->surface_vertices();
  second->color = Eigen::Vector3f(1.0f, 0.0f, 0.0f);
  const Eigen::Vector3f own = first->color;
  ASSERT_TRUE(first->join(*second));
  EXPECT_EQ(first->particle_colors().col(0), own);
  EXPECT_EQ(first->particle_colors().rightCols<1>(), second->color);
  EXPECT_EQ(first->surface_colors().cols(), first->surface_vertices());
  EXPECT_EQ(first->surface_colors().rightCols<1>(), second->color);
  ASSERT_EQ(first->particles().size(), n + m);
  EXPECT_NEAR(first->particles().mass.sum(), mass, 1e-15);
  EXPECT_TRUE(first->particles().is_fixed(n + 4));
  EXPECT_EQ(first->surface().vertices.rightCols(surface.vertices.cols()), surface.vertices);
  EXPECT_EQ(first->surface_triangles().rightCols(surface.triangles.cols()),
            Eigen::Matrix3Xi(surface.triangles.array() + offset));
  EXPECT_EQ(first->tetrahedra()->vertices.cols(), n + m);
  EXPECT_NO_THROW(validate(*first->tetrahedra(), "joined"));
  // Nothing pulls at either: energies are those of rest.
  EXPECT_NEAR(first->system().elastic_energy(), 0.0, 1e-18);
  EXPECT_EQ(first->point_fields().at("strain").size(), n + m);
}

TEST(PatchModel, RefusesWhatItCannotBe) {
  const auto& entry = model_registry().find("patch");
  const auto make = [&](const ParameterText& material, const BodyGeometry& geometry) {
    entry.make(parse_parameters(entry.parameters, material, "material"), geometry);
  };
  const BodyGeometry ball = make_patch_geometry(PatchScene());
  BodyGeometry sheet{make_grid({1.0, 1.0, 3, 3}), {}};
  expect_refusal([&] { make({}, sheet); }, {"'patch' needs", "inside"});
  expect_refusal([&] { make({{"poisson", "0.5"}}, ball); }, {"'poisson'", "0.499"});
  expect_refusal([&] { make({{"poisson", "-0.1"}}, ball); }, {"'poisson'"});
  expect_refusal([&] { make({{"young", "0"}}, ball); }, {"'young'"});
  expect_refusal([&] { make({{"density", "nan"}}, ball); }, {"'density'"});
  expect_refusal([&] { make({{"fiber_direction", "[0, 0, 0]"}}, ball); }, {"'fiber_direction'"});
  BodyGeometry flat = ball;
  flat.tetrahedra->vertices.row(2).setZero();
  expect_refusal([&] { make({}, flat); }, {"flat"});
}

}  // namespace
}  // namespace pliant
