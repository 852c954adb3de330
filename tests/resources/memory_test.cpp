// What a large scene takes from the heap.
#include <gtest/gtest.h>

#include <algorithm>

#include "resources/heap.h"
#include "support/worlds.h"

namespace pliant {
namespace {

constexpr int kNodes = 200 * 200;

/// A hanging cloth of the default fabric, bending included.
std::unique_ptr<World> hanging(const std::string& solver) {
  ClothScene scene;
  scene.grid = {1.0, 1.0, 200, 200};
  scene.fixed = {0, 199};
  scene.solver = solver;
  scene.solver_parameters = with_iterations(solver, 5);
  scene.time_step = is_explicit(solver) ? 1e-5 : 1e-3;
  scene.effects = {{"gravity", {}}, {"damping", {}}};
  return make_world(scene);
}

class Memory : public EverySolver {};

/// Those that keep no matrix.
INSTANTIATE_TEST_SUITE_P(Solvers, Memory, testing::Values("verlet", "xpbd"), test_name_of);

// From its geometry to some steps.
TEST_P(Memory, PeakIsBelowOneKilobyteANode) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  const HeapWatch watch;
  const auto world = hanging(solver());
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world->step());
  ASSERT_EQ(particles_of(*world).size(), kNodes);
  RecordProperty("bytes_per_node", std::to_string(watch.peak() / kNodes));
  EXPECT_LT(watch.peak() / kNodes, 1024u);
}

/// Without those that keep a factor or a Hessian, which grow faster than the number of nodes.
std::vector<std::string> solvers_without_a_factor() {
  std::vector<std::string> names = cloth_solvers();
  const auto factors = [](const std::string& solver) {
    return solver == "direct" || solver == "lbfgs" || solver == "newton";
  };
  names.erase(std::remove_if(names.begin(), names.end(), factors), names.end());
  return names;
}

class MemoryKept : public EverySolver {};
INSTANTIATE_TEST_SUITE_P(Solvers, MemoryKept, testing::ValuesIn(solvers_without_a_factor()),
                         test_name_of);

TEST_P(MemoryKept, IsBelowOneKilobyteANode) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  const HeapWatch watch;
  const auto world = hanging(solver());
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world->step());
  RecordProperty("bytes_per_node", std::to_string(watch.in_use() / kNodes));
  EXPECT_LT(watch.in_use() / kNodes, 1024u);
}

}  // namespace
}  // namespace pliant
