// What a step of a reduced body takes from the heap.
#include <gtest/gtest.h>

#include "pliant/effects/attachment.h"
#include "resources/heap.h"
#include "support/worlds/reduced_worlds.h"

namespace pliant {
namespace {

TEST(ReducedSteps, AllocateNothingInContact) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  for (const char* solver : {"trigonometric", "newmark", "midpoint", "stoermer_verlet"}) {
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

TEST(ReducedSteps, AllocateNothingWhileHeld) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  ReducedScene s;
  s.solver = "trigonometric";
  s.effects = {{"gravity", {}}};
  auto world = make_world(s);
  AttachmentRequest request;
  request.name = "hook";
  request.count = particles_of(*world).size();
  request.stiffness = 1e3;
  ASSERT_FALSE(particles_of(*world).is_fixed(98));
  request.region.vertices = {98};
  attachments_of(body_of(*world), world->obstacles()).add(request);
  run_for(*world, 0.5);
  const HeapWatch watch;
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(world->step());
  EXPECT_EQ(watch.allocations(), 0);
}

}  // namespace
}  // namespace pliant
