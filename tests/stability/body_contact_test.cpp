// Nothing passes: random bodies thrown at each other, with every solver and few iterations.
#include <gtest/gtest.h>

#include "support/body_pairs.h"
#include "support/random.h"

namespace pliant::body_contact_stability_test {
namespace {

/// A body of some model about `center`, turned at random and thrown towards the origin.
std::string thrown(const std::string& name, const Eigen::Vector3d& center, double speed,
                   Random& random) {
  const char* const models[] = {
      "model: cloth, geometry: {grid: {size: [0.1, 0.1], vertices: [7, 7]}}, material: "
      "{areal_density: 0.2}",
      "model: patch, geometry: {block: {size: [0.07, 0.05, 0.04], cells: [3, 2, 2]}}, material: "
      "{young: 1.0e+5, density: 500}",
      "model: rigid, geometry: {box: {size: [0.06, 0.05, 0.04]}}, material: {density: 500}"};
  const auto pick = static_cast<std::size_t>(random(0.0, 2.999));
  const Eigen::Vector3d turn = random.vector(3.0), v = -speed * center.normalized();
  return fmt::format(
      "  - {{name: {}, {}, position: [{}, {}, {}], rotation_rpy: [{}, {}, {}], velocity: [{}, {}, "
      "{}]}}\n",
      name, models[pick], center.x(), center.y(), center.z(), turn.x(), turn.y(), turn.z(), v.x(),
      v.y(), v.z());
}

class ThrownBodies : public testing::TestWithParam<int> {};

TEST_P(ThrownBodies, NeverPass) {
  Random random(static_cast<unsigned>(GetParam()));
  const double speed = random(0.5, 20.0);
  std::vector<std::string> bodies;
  const Eigen::Vector3d places[] = {{0.14, 0.0, 0.3}, {-0.14, 0.01, 0.3}, {0.0, 0.15, 0.32}};
  for (int b = 0; b < 3; ++b) {
    const Eigen::Vector3d center = places[b] - Eigen::Vector3d(0.0, 0.0, 0.3);
    bodies.push_back(thrown(fmt::format("body_{}", b), center, speed, random));
  }
  const auto world = world_of(scene_text(bodies, "  body_contact: {}\n"));
  ASSERT_EQ(intersections_between(*world), 0);
  for (int k = 0; k < 40; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    ASSERT_EQ(intersections_between(*world), 0) << "step " << k << " at " << speed << " m/s";
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, ThrownBodies, testing::Range(0, 100));

class FewIterations : public testing::TestWithParam<std::string> {};

TEST_P(FewIterations, LetNothingPass) {
  for (const int iterations : {1, 3}) {
    const std::string solver =
        fmt::format("solver: {{name: {}, iterations: {}}}\n", GetParam(), iterations);
    const auto world = world_of(scene_text(
        {slab("lower", "patch", 0.03), slab("upper", "cloth", 0.08, "velocity: [0.5, 0, -10]")},
        "  gravity: {}\n  contact: {}\n  body_contact: {}\n",
        "obstacles: [{name: table, shape: plane}]\n" + solver));
    for (int k = 0; k < 40; ++k) {
      ASSERT_TRUE(world->step()) << world->failure();
      ASSERT_EQ(intersections_between(*world), 0) << "step " << k << ", " << iterations;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, FewIterations,
                         testing::Values("xpbd", "jacobi", "weighted_jacobi", "gauss_seidel",
                                         "hybrid", "chebyshev", "direct", "lbfgs", "newton"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace pliant::body_contact_stability_test
