// A scene pays only for its effects: instances, calls and allocations are counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>

#include "support/worlds.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PLIANT_COUNTS_ALLOCATIONS 1

namespace {
std::atomic<bool> counting{false};
std::atomic<int> allocations{0};

void count() {
  if (counting.load(std::memory_order_relaxed)) ++allocations;
}
}  // namespace

// Eigen allocates by malloc, the standard library by operator new, which glibc's malloc serves too.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  count();
  return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) {
  count();
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
}
#endif

namespace pliant {
namespace {

const std::vector<std::pair<std::string, ParameterText>> kEveryEffect = {
    {"gravity", {}}, {"damping", {}}, {"air", {{"volume", "1e-4"}}}, {"contact", {}}, {"friction", {}}};

class PayPerEffect : public EverySolver {
 protected:
  ClothScene scene() const {
    ClothScene s;
    s.solver = GetParam();
    s.material = soft_material();
    s.obstacles = {obstacle(Plane()), obstacle(Box(Eigen::Vector3d(0.05, 0.05, 0.01)))};
    s.pose = at(0, 0, 0.01);
    s.time_step = 1e-3;
    return s;
  }
};
PLIANT_FOR_EVERY_SOLVER(PayPerEffect);

TEST_P(PayPerEffect, WithoutEffectsThereAreNoInstancesNorCalls) {
  auto world = make_world(scene());
  run_for(*world, 0.01);
  const Body& body = body_of(*world);
  EXPECT_TRUE(body.effects.empty());
  EXPECT_TRUE(dynamic_cast<const ProjectiveSystem&>(body.model->system()).couplings.empty());
  const std::vector<std::string> names = effect_registry().names();
  for (const PhaseTime& phase : body.report.phases) {
    EXPECT_EQ(std::count(names.begin(), names.end(), phase.name), 0) << phase.name;
  }
}

TEST_P(PayPerEffect, EachEffectHasOneInstanceAndOneLineOfTime) {
  for (std::size_t present = 0; present <= kEveryEffect.size(); ++present) {
    ClothScene s = scene();
    s.effects.assign(kEveryEffect.begin(), kEveryEffect.begin() + static_cast<long>(present));
    auto world = make_world(s);
    ASSERT_TRUE(world->step());
    const Body& body = body_of(*world);
    ASSERT_EQ(body.effects.size(), present);
    for (std::size_t k = 0; k < kEveryEffect.size(); ++k) {
      const std::string& name = kEveryEffect[k].first;
      const auto same = [&](const PhaseTime& phase) { return phase.name == name; };
      EXPECT_EQ(body.find_effect(name) != nullptr, k < present);
      EXPECT_EQ(std::count_if(body.report.phases.begin(), body.report.phases.end(), same),
                k < present ? 1 : 0) << name;
    }
  }
}

#ifdef PLIANT_COUNTS_ALLOCATIONS
/// Allocations in 20 steps after `warm_up` seconds.
int allocations_after(World& world, double warm_up) {
  run_for(world, warm_up);
  allocations = 0;
  counting = true;
  for (int k = 0; k < 20; ++k) world.step();
  counting = false;
  return allocations;
}

TEST(Allocations, AreSeen) {
  allocations = 0;
  counting = true;
  Eigen::VectorXd by_eigen(100);
  auto by_new = std::make_unique<std::vector<int>>(100);
  counting = false;
  EXPECT_EQ(allocations, 3);
}

TEST_P(PayPerEffect, AStepAllocatesNothing) {
  ClothScene s = scene();
  s.fixed = {0};
  auto world = make_world(s);
  EXPECT_EQ(allocations_after(*world, 0.01), 0);
}

TEST_P(PayPerEffect, AStepWithEveryEffectAllocatesNothing) {
  for (const auto& effect : kEveryEffect) {
    ClothScene s = scene();
    s.effects = {effect};
    if (effect.first == "friction") s.effects = {{"contact", {}}, effect};
    auto world = make_world(s);
    EXPECT_EQ(allocations_after(*world, 0.01), 0) << effect.first;
  }
  ClothScene s = scene();
  s.effects = kEveryEffect;
  auto world = make_world(s);
  // Long enough to lie on the plane with all of its contacts.
  EXPECT_EQ(allocations_after(*world, 0.5), 0);
}
#endif

}  // namespace
}  // namespace pliant
