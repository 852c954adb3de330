// Cloth and particles that touch themselves with the CUDA backend's solvers, their kernels run by
// the CPU: they take the path of the CPU's solvers, and nothing passes.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/math/error.h"
#include "support/meshes/intersections.h"
#include "support/solvers/device_solvers.h"
#include "support/worlds/crumpling_sheet.h"
#include "support/worlds/patch_worlds.h"

namespace pliant::device_self_contact_test {
namespace {

constexpr double kThickness = 0.004;  // [m]

/// One half of a sheet lies still, the other one hangs over it, a little above, and slides as it
/// comes down.
ClothScene folded(const std::string& solver, const ParameterText& parameters) {
  ClothScene scene;
  scene.grid = {0.3, 0.15, 9, 5};
  scene.material = {
      {"stretch_warp", "20"}, {"stretch_weft", "20"}, {"shear", "4"}, {"bending", "1e-4"}};
  for (int i = 0; i < 9 * 5; ++i) {
    if (i % 9 <= 4) scene.fixed.push_back(i);
  }
  scene.effects = {{"gravity", {}},
                   {"damping", {{"rate", "4"}}},
                   {"self_contact", {{"thickness", "0.004"}, {"friction", "0.3"}}}};
  scene.solver = solver;
  scene.solver_parameters = parameters;
  return scene;
}

std::unique_ptr<World> folded_world(const std::string& solver, const ParameterText& parameters) {
  auto world = make_world(folded(solver, parameters));
  Particles& particles = body_of(*world).particles();
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) continue;
    particles.x(0, i) = -particles.x(0, i) + 0.005;
    particles.x(2, i) += 1.5 * kThickness;
    particles.v(1, i) = 0.2;
  }
  return world;
}

class DeviceSelfContact : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, DeviceSelfContact,
                         testing::Values("jacobi", "chebyshev", "lbfgs"),
                         [](const auto& info) { return info.param; });

TEST_P(DeviceSelfContact, ALayerComesDownOnAnotherAsOnTheCpu) {
  const auto exact = folded_world("jacobi", {{"iterations", "5000"}, {"tolerance", "1e-9"}});
  const auto world = folded_world("jacobi", {});
  body_of(*world).solver = make_host_device_solver(GetParam(), {2000, 1e-5, 0.0});
  world->system_changed();
  const Positions& x = particles_of(*world).x;
  const double size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
  int contacts = 0;
  for (int s = 0; s < 15; ++s) {
    ASSERT_TRUE(exact->step()) << exact->failure();
    ASSERT_TRUE(world->step()) << world->failure();
    EXPECT_EQ(body_of(*world).report.backend, "cuda");
    contacts = std::max(contacts, body_of(*world).report.contacts);
    const double off = (x - particles_of(*exact).x).colwise().norm().maxCoeff();
    EXPECT_LE(off, 1e-4 * size) << "step " << s;
  }
  EXPECT_GT(contacts, 10) << "the scene tests nothing";
}

TEST(DeviceSelfContactScene, AFallingSheetCrumplesAndDoesNotPass) {
  const auto world = make_world(crumpling_sheet());
  Body& body = body_of(*world);
  body.solver = make_host_device_solver("chebyshev", {30, 0.0, 0.0});
  world->system_changed();
  for (int step = 1; step <= 120; ++step) {
    ASSERT_TRUE(world->step()) << world->failure();
    if (step % 20 != 0) continue;
    EXPECT_EQ(count_intersections(body.particles().x, body.model->surface_triangles()), 0) << step;
  }
  EXPECT_LT(body.particles().x.row(2).maxCoeff(), 0.2) << "it still stands";
}

TEST(DeviceSelfContactScene, OfTetrahedraIsRefusedByName) {
  PatchScene scene = falling_block("jacobi", {});
  scene.effects.push_back({"self_contact", {}});
  const auto world = make_world(scene);
  body_of(*world).solver = make_host_device_solver("jacobi", {30, 0.0, 0.0});
  try {
    world->system_changed();
    world->step();
    FAIL() << "it was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'self_contact' of tetrahedra"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace pliant::device_self_contact_test
