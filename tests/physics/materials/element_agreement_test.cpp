// Every solver finds the same step for every kind of element.
#include <gtest/gtest.h>

#include <tuple>

#include "support/solvers/system_model.h"
#include "support/worlds/worlds.h"
#include "unit/elements/element_examples.h"

namespace pliant::element_agreement_test {
namespace {

ElementExample example_named(const std::string& kind) {
  if (kind == "bending") return make_example<BendingSet>(3);
  if (kind == "tetrahedron") return make_example<TetrahedronSet>(3);
  if (kind == "volume") return make_example<VolumeSet>(3);
  if (kind == "strain_limit") return make_example<StrainLimitSet>(3);
  if (kind == "fiber") return make_example<FiberSet>(3);
  if (kind == "triangle_strain") return make_example<TriangleStrainSet>(3);
  if (kind == "cluster") return make_example<ClusterSet>(3);
  if (kind == "oriented_cluster") return make_example<OrientedClusterSet>(3);
  return make_example<AttachmentSet>(3);
}

/// A disturbed body with two fixed particles after three steps.
std::unique_ptr<World> after_three_steps(const std::string& kind, const std::string& solver) {
  ElementExample example = example_named(kind);
  Random random(12);
  const int n = static_cast<int>(example.rest.cols());
  const Positions x = example.rest + random.positions(n, 0.01);
  auto model = std::make_unique<SystemModel>(x, 1e-3);
  model->add(std::move(example.set));
  model->particles().v = random.positions(n, 1.0);
  model->particles().fix(0);
  model->particles().fix(5);
  auto world =
      world_of(std::move(model), 2e-3, solver, {{"iterations", "20000"}, {"tolerance", "1e-11"}});
  for (int step = 0; step < 3; ++step) {
    EXPECT_TRUE(world->step()) << body_of(*world).report.failure;
  }
  return world;
}

using KindAndSolver = std::tuple<std::string, std::string>;
class ElementAgreement : public testing::TestWithParam<KindAndSolver> {};

TEST_P(ElementAgreement, ConvergesToNewtonsStep) {
  const auto& [kind, solver] = GetParam();
  auto reference = after_three_steps(kind, "newton");
  auto other = after_three_steps(kind, solver);
  const Positions& x = particles_of(*reference).x;
  const double moved = (x - particles_of(*reference).x_start).colwise().norm().maxCoeff();
  EXPECT_LE((particles_of(*other).x - x).colwise().norm().maxCoeff(), 1e-6 * moved);
}

INSTANTIATE_TEST_SUITE_P(
    All, ElementAgreement,
    testing::Combine(testing::Values("bending", "tetrahedron", "volume", "strain_limit", "fiber",
                                     "triangle_strain", "cluster", "oriented_cluster",
                                     "attachment"),
                     testing::Values("xpbd", "jacobi", "line_search_jacobi", "gauss_seidel",
                                     "hybrid", "chebyshev", "direct", "lbfgs")),
    [](const auto& info) { return std::get<0>(info.param) + "_" + std::get<1>(info.param); });

}  // namespace
}  // namespace pliant::element_agreement_test
