// What a step of a reduced body takes from the heap.
#include <gtest/gtest.h>

#include "resources/heap.h"
#include "support/reduced_worlds.h"

namespace pliant {
namespace {

TEST(ReducedSteps, AllocateNothingInContact) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  for (const char* solver : {"imex", "newmark", "midpoint", "stoermer_verlet"}) {
    ReducedScene s;
    s.solver = solver;
    s.time_step = 0.0005;
    s.material = {{"alpha", "5"}};
    s.obstacles = {obstacle(Sphere(0.1), at(0.4, 0.0, -0.152))};
    s.effects = {{"gravity", {}}, {"damping", {}}, {"contact", {}}, {"friction", {}}};
    auto world = make_world(s);
    run_for(*world, 1.0);
    ASSERT_GT(body_of(*world).report.contacts, 0) << solver;
    const HeapWatch watch;
    for (int k = 0; k < 20; ++k) ASSERT_TRUE(world->step());
    EXPECT_EQ(watch.allocations(), 0) << solver;
    EXPECT_TRUE(body_of(*world).report.warnings.empty()) << body_of(*world).report.warnings.front();
  }
}

}  // namespace
}  // namespace pliant
