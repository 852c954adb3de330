// A scene pays only for its effects: instances, calls and allocations are counted.
#include <gtest/gtest.h>

#include <algorithm>

#include "resources/heap.h"
#include "support/disturb.h"
#include "support/solvers/projective_model.h"

namespace pliant {
namespace {

using Effects = std::vector<std::pair<std::string, ParameterText>>;

/// In the registry's order; but for those that a solver is refused with.
Effects every_effect(const std::string& solver) {
  Effects effects = {{"gravity", {}},
                     {"damping", {}},
                     {"strain_limit", {{"max", "1.01"}}},
                     {"air", {{"volume", "1e-4"}, {"permeability", "0.01"}}},
                     {"self_contact", {}},
                     {"body_contact", {}},
                     {"contact", {}},
                     {"friction", {}},
                     {"wetness", {{"wetness", "0.5"}}}};
  if (solver == "direct" || solver == "newton") effects.erase(effects.begin() + 4);
  return effects;
}

TEST(PayPerEffectTests, KnowEveryEffect) {
  std::vector<std::string> known;
  for (const auto& effect : every_effect("xpbd")) known.push_back(effect.first);
  EXPECT_EQ(known, effect_registry().names_for("cloth")) << "add the new effect to every_effect";
}

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
  EXPECT_TRUE(projective_system(*body.model).constraints.empty());
  const std::vector<std::string> names = effect_registry().names();
  for (const PhaseTime& phase : body.report.phases) {
    EXPECT_EQ(std::count(names.begin(), names.end(), phase.name), 0) << phase.name;
  }
}

TEST_P(PayPerEffect, EachEffectHasOneInstanceAndOneLineOfTime) {
  const Effects all = every_effect(GetParam());
  for (std::size_t present = 0; present <= all.size(); ++present) {
    ClothScene s = scene();
    s.effects.assign(all.begin(), all.begin() + static_cast<long>(present));
    auto world = make_world(s);
    ASSERT_TRUE(world->step());
    const Body& body = body_of(*world);
    ASSERT_EQ(body.effects.size(), present);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::string& name = all[k].first;
      const auto same = [&](const PhaseTime& phase) { return phase.name == name; };
      EXPECT_EQ(body.find_effect(name) != nullptr, k < present);
      EXPECT_EQ(std::count_if(body.report.phases.begin(), body.report.phases.end(), same),
                k < present ? 1 : 0)
          << name;
    }
  }
}

/// Counts its instances and calls.
class Counted final : public Effect, public Constraint {
 public:
  struct Calls {
    int instances = 0, before = 0, after = 0, begin = 0, relax = 0, finish = 0, report = 0;
    int energy = 0;
  };
  explicit Counted(Calls& calls) : calls_(calls) { ++calls_.instances; }

  std::string_view name() const override { return "counted"; }
  void before_step(Body&, double) override { ++calls_.before; }
  void after_step(Body&, double) override { ++calls_.after; }
  Constraint* constraint() override { return this; }
  double potential_energy(const Body&) const override { return ++calls_.energy, 0.0; }

  void begin_step(const Particles&, double) override { ++calls_.begin; }
  void reset_multipliers() override {}
  void relax(const Eigen::VectorXd&, Positions&) override { ++calls_.relax; }
  void add_forces(Forces&) const override {}
  void add_rows(const Positions&, ConstraintRows&) override {}
  void final_projection(const Eigen::VectorXd&, Positions&) override { ++calls_.finish; }
  void report(StepReport&) const override { ++calls_.report; }

 private:
  Calls& calls_;
};

TEST_P(PayPerEffect, HooksAreCalledOnceAStepWhereTheSceneNamesIt) {
  Counted::Calls calls;
  EffectRegistry registry("effect");
  registry.add({"counted", "counts", {}, {"cloth"}, [&](const Parameters&, const EffectSite&) {
                  return std::make_unique<Counted>(calls);
                }});
  const auto without = make_world(scene()), with = make_world(scene());
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(without->step());
  EXPECT_EQ(calls.instances, 0);
  with->add_effect(body_of(*with), registry, "counted", {}, "test");
  with->system_changed();
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(with->step());
  EXPECT_EQ(calls.instances, 1);
  for (const int once : {calls.before, calls.after, calls.begin, calls.finish, calls.report}) {
    EXPECT_EQ(once, 10);
  }
  EXPECT_GE(calls.relax, 10);
  // What only an observer wants costs a step nothing.
  EXPECT_EQ(calls.energy, 0);
}

/// Allocations in 20 steps after `warm_up` seconds.
int allocations_after(World& world, double warm_up) {
  // Stirred: a solver that finds nothing to do shows nothing.
  disturb(world, 0.0, 0.1);
  run_for(world, warm_up);
  const HeapWatch watch;
  for (int k = 0; k < 20; ++k) world.step();
  return watch.allocations();
}

TEST_P(PayPerEffect, AStepAllocatesNothing) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  ClothScene s = scene();
  s.fixed = {0};
  auto world = make_world(s);
  EXPECT_EQ(allocations_after(*world, 0.01), 0);
}

TEST_P(PayPerEffect, AStepWithEveryEffectAllocatesNothing) {
  if (!HeapWatch::works()) GTEST_SKIP() << "a sanitizer has the heap";
  for (const auto& effect : every_effect(GetParam())) {
    ClothScene s = scene();
    s.effects = {effect};
    if (effect.first == "friction") s.effects = {{"contact", {}}, effect};
    auto world = make_world(s);
    EXPECT_EQ(allocations_after(*world, 0.01), 0) << effect.first;
  }
  ClothScene s = scene();
  s.effects = every_effect(GetParam());
  auto world = make_world(s);
  // Long enough for the air to leak, and the cloth to lie on the plane with all of its contacts.
  EXPECT_EQ(allocations_after(*world, 0.5), 0);
  EXPECT_GT(body_of(*world).report.contacts, 0);
}

}  // namespace
}  // namespace pliant
