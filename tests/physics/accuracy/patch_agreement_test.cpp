// Bodies of the model `patch`: all implicit solvers find the same step, and momentum is what forces
// made of it.
#include <gtest/gtest.h>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "support/worlds/patch_worlds.h"

namespace pliant::patch_agreement_test {
namespace {

class PatchAgreement : public ::testing::TestWithParam<std::string> {};

TEST_P(PatchAgreement, SameStepsWithContact) {
  const ParameterText converged = {{"iterations", "20000"}, {"tolerance", "1e-9"}};
  auto reference = make_world(falling_block("newton", converged));
  auto world = make_world(falling_block(GetParam(), converged));
  for (int s = 0; s < 12; ++s) {
    ASSERT_TRUE(reference->step()) << reference->failure();
    ASSERT_TRUE(world->step()) << world->failure();
  }
  EXPECT_GT(body_of(*reference).report.contacts, 2);
  const double error = (particles_of(*world).x - particles_of(*reference).x).norm() /
                       std::sqrt(static_cast<double>(particles_of(*world).size()));
  // Residuals of 1e-9 in each step, amplified by the stiffness ratio of a few hundred.
  EXPECT_LT(error, 1e-6 * 0.1);
}

INSTANTIATE_TEST_SUITE_P(Solvers, PatchAgreement,
                         ::testing::Values("chebyshev", "jacobi", "line_search_jacobi",
                                           "gauss_seidel", "hybrid", "direct", "lbfgs"));

TEST(PatchMomentum, IsTheImpulseOfTheForces) {
  PatchScene scene;
  scene.solver_parameters = {{"iterations", "50"}, {"tolerance", "1e-12"}};
  auto world = make_world(scene);
  AppliedForce push;
  push.point = {0.05, 0.0, 0.01};
  push.radius = 0.02;
  push.force = {-1.0, 0.5, 2.0};
  push.duration = 0.1;
  world->applied_forces().add(push);
  run_for(*world, 0.3);
  const Eigen::Vector3d expected = push.force * push.duration;
  EXPECT_LT((particles_of(*world).momentum() - expected).norm(), 1e-9 * expected.norm());
}

}  // namespace
}  // namespace pliant::patch_agreement_test
