// Solvers and faults that come and go while a scene runs.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/bounds.h"

namespace pliant {
namespace {

ClothScene draped(const std::string& solver) {
  ClothScene s;
  s.solver = solver;
  s.time_step = kVerletStep;
  s.obstacles = {obstacle(Plane()), obstacle(Sphere(0.05), at(0, 0, 0.05))};
  s.pose = at(0, 0, 0.11);
  s.effects = {{"gravity", {}}, {"damping", {}}, {"contact", {}}, {"friction", {}}};
  return s;
}

TEST(Swap, EveryStepAHundredTimes) {
  auto world = make_world(draped("xpbd"));
  run_for(*world, 0.1);
  const std::vector<std::string> names = solver_registry().names();
  double energy = world->energies().total();
  for (std::size_t k = 0; k < 100; ++k) {
    const Particles before = particles_of(*world);
    world->set_solver(body_of(*world), solver_registry(), names[k % names.size()], {}, "test");
    ASSERT_EQ(particles_of(*world).x, before.x);
    ASSERT_EQ(particles_of(*world).v, before.v);
    ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    ASSERT_EQ(body_of(*world).report.solver, names[k % names.size()]);
  }
  // No solver adds energy, and swapping does not either; verlet's oscillates by a step's exchange.
  EXPECT_LE(world->energies().total(), energy * 1.001);
  EXPECT_LE(extent(*world), 0.3);
}

TEST(Swap, ToTheSameSolverChangesNothing) {
  for (const std::string& name : solver_registry().names()) {
    auto swapped = make_world(draped(name)), alone = make_world(draped(name));
    for (int k = 0; k < 200; ++k) {
      swapped->set_solver(body_of(*swapped), solver_registry(), name, {}, "test");
      ASSERT_TRUE(swapped->step());
      ASSERT_TRUE(alone->step());
    }
    EXPECT_EQ(particles_of(*swapped).x, particles_of(*alone).x) << name;
  }
}

/// Adds a force that is not a number to a vertex in every tenth step.
class Hiccup final : public Effect {
 public:
  std::string_view name() const override { return "hiccup"; }
  void before_step(Body& body, double) override {
    if (++calls_ % 10 != 0) return;
    auto& system = dynamic_cast<ProjectiveSystem&>(body.model->system());
    system.external_forces.col(30).setConstant(std::numeric_limits<double>::quiet_NaN());
  }

 private:
  int calls_ = 0;
};

class Faulty : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(Faulty);

TEST_P(Faulty, NotANumberIsRolledBackEveryTime) {
  auto world = make_world(draped(GetParam())), clean = make_world(draped(GetParam()));
  body_of(*world).effects.push_back(std::make_unique<Hiccup>());
  int good = 0, bad = 0;
  for (int k = 0; k < 1000; ++k) (world->step() ? good : bad)++;
  EXPECT_EQ(bad, 100);
  for (int k = 0; k < good; ++k) ASSERT_TRUE(clean->step());
  EXPECT_EQ(particles_of(*world).x, particles_of(*clean).x);
  EXPECT_EQ(particles_of(*world).v, particles_of(*clean).v);
  EXPECT_EQ(world->steps(), 900u);
}

TEST_P(Faulty, NotANumberOverAirIsRolledBackToo) {
  ClothScene s = draped(GetParam());
  s.obstacles = {obstacle(Plane())};
  s.pose = at(0, 0, 0.001);
  s.effects = {{"gravity", {}},
               {"air", {{"volume", "1e-5"}, {"permeability", "1e-6"}}},
               {"contact", {}}};
  auto world = make_world(s), clean = make_world(s);
  body_of(*world).effects.push_back(std::make_unique<Hiccup>());
  int good = 0;
  for (int k = 0; k < 200; ++k) good += world->step();
  EXPECT_EQ(good, 180);
  for (int k = 0; k < good; ++k) ASSERT_TRUE(clean->step());
  EXPECT_EQ(particles_of(*world).x, particles_of(*clean).x);
}

}  // namespace
}  // namespace pliant
