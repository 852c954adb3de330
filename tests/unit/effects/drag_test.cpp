#include "pliant/effects/drag.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/models/solver_registry.h"
#include "support/expect_refusal.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::drag_test {
namespace {

constexpr double kGravity = 9.81;

/// A body of every model as a scene file lists it, its middle 1 m above the origin.
struct Dragged {
  std::string body;
  std::string solver = "newton, tolerance: 1.0e-10, iterations: 50";
};

std::vector<Dragged> every_model() {
  return {{slab("body", "cloth", 1.0)},
          {slab("body", "patch", 1.0)},
          {slab("body", "rigid", 1.0), "xpbd, iterations: 50"},
          {slab("body", "viscoelastic", 1.0)},
          {"  - {name: body, model: reduced, position: [0, 0, 1],\n"
           "     geometry: {example: {name: beam, young: 1.0e+6, modes: 4, rank: 8}}}\n",
           "trigonometric"}};
}

std::string text_of(const Dragged& dragged, const std::string& effects) {
  return scene_text({dragged.body}, effects, "solver: {name: " + dragged.solver + "}\n");
}

std::unique_ptr<World> hanging(const Dragged& dragged) {
  return world_of(text_of(dragged,
                          "  gravity: {acceleration: [0, 0, -9.81]}\n"
                          "  damping: {rate: 5}\n"));
}

std::unique_ptr<World> floating(const Dragged& dragged) {
  return world_of(text_of(dragged, "  damping: {rate: 0}\n"));
}

/// Grabs the vertices of the first body that are near a point of it.
DragEffect& grab_at(World& world, const Eigen::Vector3d& point, double radius,
                    const DragSpring& spring = {}) {
  Body& body = body_of(world);
  DragEffect& drag = drag_of(body);
  drag.grab(region_to_grab(body, point, radius), spring, world.time_step());
  return drag;
}

DragEffect& grab_end(World& world, const DragSpring& spring = {}) {
  const Positions& x = particles_of(world).x;
  return grab_at(world, {x.row(0).maxCoeff(), 0.0, 1.0}, 0.02, spring);
}

void steps(World& world, int count) {
  for (int k = 0; k < count; ++k) ASSERT_TRUE(world.step()) << world.failure();
}

TEST(Drag, CarriesTheWeightOfEveryModelWhereItsSpringSays) {
  for (const Dragged& dragged : every_model()) {
    SCOPED_TRACE(dragged.body);
    const auto world = hanging(dragged);
    const bool stands = body_of(*world).model->name() == "reduced";
    DragEffect& drag = grab_end(*world);
    const Eigen::Vector3d target = drag.center() + Eigen::Vector3d(0.02, 0.01, 0.03);
    drag.move_to(target);
    steps(*world, 400);
    const Eigen::Vector3d stretch = target - drag.center();
    // At rest the damper carries nothing.
    EXPECT_LE((drag.stiffness() * stretch - drag.force()).norm(), 0.02 * drag.force().norm());
    if (stands) continue;  // a beam whose foot is fixed carries a part of it
    const double weight = particles_of(*world).mass.sum() * kGravity;
    EXPECT_NEAR(stretch.z(), weight / drag.stiffness(), 0.02 * weight / drag.stiffness());
    EXPECT_NEAR(stretch.z(), kGravity / std::pow(10.0 * kPi, 2), 2e-4);
  }
}

TEST(Drag, GivesTheMomentumOfItsForce) {
  for (const Dragged& dragged : every_model()) {
    SCOPED_TRACE(dragged.body);
    const auto world = floating(dragged);
    Body& body = body_of(*world);
    if (body.model->name() == "reduced") continue;  // its foot takes some of it
    DragEffect& drag = grab_end(*world);
    drag.move_to(drag.center() + Eigen::Vector3d(0.01, -0.02, 0.015));
    Eigen::Vector3d given = Eigen::Vector3d::Zero();
    for (int k = 0; k < 20; ++k) {
      ASSERT_TRUE(world->step());
      given += world->time_step() * drag.force();
    }
    EXPECT_GT(given.norm(), 0.0);
    EXPECT_LE((body.particles().momentum() - given).norm(), 1e-9 * given.norm());
  }
}

bool is_reduced(const Dragged& dragged) {
  return dragged.body.find("model: reduced") != std::string::npos;
}

/// A body is dragged to 100 m away and, while it is fast, back, by no more than three times its
/// mass in newtons.
void expect_limited(const Dragged& dragged) {
  SCOPED_TRACE(dragged.body);
  const auto world = hanging(dragged);
  DragSpring spring;
  spring.force_limit = 3.0 * body_of(*world).particles().mass.sum();
  DragEffect& drag = grab_end(*world, spring);
  const Eigen::Vector3d first = drag.center();
  double largest = 0.0;
  for (const double place : {100.0, -100.0}) {
    drag.move_to(first + Eigen::Vector3d(place, 0.3 * place, 0.0));
    for (int k = 0; k < 30; ++k) {
      ASSERT_TRUE(world->step());
      largest = std::max(largest, drag.force().norm());
    }
  }
  // What the springs of a body of particles change of the vertices' path in one step is not known
  // before.
  EXPECT_LE(largest, (is_reduced(dragged) ? 1.0 + 1e-9 : 1.1) * spring.force_limit);
  EXPECT_GE(largest, 0.7 * spring.force_limit);
}

TEST(Drag, PullsNoHarderThanItsLimit) {
  for (const Dragged& dragged : every_model()) expect_limited(dragged);
}

TEST(Drag, ItsOwnLimitIsThatOfFiftyMetresPerSecondSquared) {
  const auto world = floating(every_model()[2]);
  DragEffect& drag = grab_end(*world);
  drag.move_to(drag.center() + Eigen::Vector3d(0.0, 0.0, 100.0));
  steps(*world, 20);
  const Particles& particles = particles_of(*world);
  EXPECT_DOUBLE_EQ(drag.force_limit(), 50.0 * particles.mass.sum());
  // The damper lets it go as fast as that force drives it.
  const double w = 10.0 * kPi, speed = 50.0 / (2.0 * w + world->time_step() * w * w);
  EXPECT_NEAR(particles.v.row(2).mean(), speed, 0.02 * speed);
}

TEST(Drag, IsStableAtAnyStiffnessOfSpringAndBodyAndAnyStep) {
  for (const double young : {1e4, 1e6, 1e8}) {
    for (const double dt : {0.001, 0.005, 0.01}) {
      for (const double stiffness : {0.0, 1e2, 1e8}) {
        SCOPED_TRACE(::testing::PrintToString(std::vector<double>{young, dt, stiffness}));
        const auto world = world_of(
            fmt::format("time_step: {}\nbodies:\n"
                        "  - {{name: body, model: patch, position: [0, 0, 1],\n"
                        "     geometry: {{block: {{size: [0.1, 0.1, 0.05], cells: [2, 2, 1]}}}},\n"
                        "     material: {{young: {}, density: 500}}}}\n"
                        "effects:\n  gravity: {{acceleration: [0, 0, -9.81]}}\n"
                        "solver: {{name: direct, iterations: 10}}\n",
                        dt, fmt::format("{:.1e}", young)));
        DragSpring spring;
        spring.stiffness = stiffness;
        DragEffect& drag = grab_end(*world, spring);
        const Eigen::Vector3d first = drag.center();
        // A hand that jumps to and fro.
        for (int k = 0; k < 200; ++k) {
          if (k % 20 == 0) drag.move_to(first + Eigen::Vector3d(k % 40 == 0 ? 0.5 : -0.5, 0, 0));
          ASSERT_TRUE(world->step()) << world->failure();
        }
        const Particles& particles = particles_of(*world);
        EXPECT_LE(particles.v.colwise().norm().maxCoeff(), 50.0);
        drag.move_to(first);
        steps(*world, static_cast<int>(2.0 / dt));
        const double sag = particles.mass.sum() * kGravity / drag.stiffness();
        EXPECT_LE((drag.center() - first).norm(), 1.1 * sag + 0.005);
        EXPECT_LE(particles.center_of_mass().norm(), 1.2);
      }
    }
  }
}

TEST(Drag, IsStableWhereAnExplicitSolverMovesTheBody) {
  for (const double stiffness : {0.0, 1e8}) {
    ClothScene s;
    s.grid = {0.2, 0.2, 5, 5};
    s.material = soft_material();
    s.solver = "verlet";
    s.time_step = 0.001;
    s.effects = {{"damping", {{"rate", "3"}}}};
    const auto world = make_world(s);
    DragSpring spring;
    spring.stiffness = stiffness;
    DragEffect& drag = grab_at(*world, particles_of(*world).x.col(12), 0.06, spring);
    const Eigen::Vector3d target = drag.center() + Eigen::Vector3d(0.1, 0.0, 0.05);
    drag.move_to(target);
    steps(*world, 3000);
    EXPECT_LE((drag.center() - target).norm(), 0.01) << stiffness;
    EXPECT_LE(particles_of(*world).v.colwise().norm().maxCoeff(), 1.0) << stiffness;
  }
}

TEST(Drag, StaysStableWhenAnExplicitSolverTakesOver) {
  ClothScene s;
  s.grid = {0.2, 0.2, 5, 5};
  s.material = soft_material();
  s.time_step = 0.001;
  const auto world = make_world(s);
  DragEffect& drag = grab_at(*world, particles_of(*world).x.col(12), 0.06, {1e6, 0.0});
  drag.move_to(drag.center() + Eigen::Vector3d(0.1, 0.0, 0.05));
  steps(*world, 10);
  EXPECT_NEAR(drag.stiffness(), 0.5 * particles_of(*world).mass.sum() / 1e-6, 1.0);
  const double before = drag.stiffness();
  world->set_solver(body_of(*world), all_solvers(), "verlet", {}, "test");
  steps(*world, 500);
  EXPECT_LT(drag.stiffness(), before);
  EXPECT_LE(particles_of(*world).v.colwise().norm().maxCoeff(), 5.0);
}

TEST(Drag, LetsGoWithoutATrace) {
  for (const Dragged& dragged : every_model()) {
    SCOPED_TRACE(dragged.body);
    const auto world = hanging(dragged), free = hanging(dragged);
    DragEffect& drag = grab_end(*world);
    EXPECT_TRUE(drag.is_holding());
    drag.let_go(world->time_step());
    EXPECT_FALSE(drag.is_holding());
    EXPECT_EQ(drag.force(), Eigen::Vector3d::Zero());
    steps(*world, 10);
    steps(*free, 10);
    EXPECT_EQ(particles_of(*world).x, particles_of(*free).x);
  }
}

TEST(Drag, TakesTheNearestVertexWhereNoneIsWithinTheRadius) {
  const auto world = floating(every_model()[0]);
  Body& body = body_of(*world);
  const Eigen::Vector3d corner = body.particles().x.col(0);
  DragEffect& drag = drag_of(body);
  const Eigen::Vector3d beside = corner + Eigen::Vector3d(-1e-3, -2e-3, 5e-3);
  EXPECT_EQ(drag.grab(region_to_grab(body, beside, 0.0), {}, 0.005), 1);
  EXPECT_EQ(drag.center(), corner);
  body.particles().fix(0);
  EXPECT_EQ(drag.grab(region_to_grab(body, beside, 0.0), {}, 0.005), 1);
  EXPECT_NE(drag.center(), corner);
}

TEST(Drag, IsAsStrongAsThePieceThatItHolds) {
  // Two blocks that are one body, so that they may touch: the mass is that of the one grabbed.
  const auto world = world_of(scene_text({slab("a", "patch", 1.0), slab("b", "patch", 2.0)},
                                         "  self_contact: {thickness: 0.002}\n"));
  ASSERT_EQ(world->bodies().size(), 1u);
  DragEffect& drag = grab_at(*world, {0.05, 0.0, 1.0}, 0.01);
  EXPECT_NEAR(drag.force_limit(), 50.0 * 0.5 * particles_of(*world).mass.sum(), 1e-9);
}

TEST(Drag, ABodyThatNobodyDragsHasNoSuchEffect) {
  const auto world = floating(every_model()[0]);
  steps(*world, 2);
  EXPECT_EQ(body_of(*world).find_effect("drag"), nullptr);
  const std::size_t elements = body_of(*world).model->system().as_projective()->elements.size();
  drag_of(body_of(*world));
  EXPECT_EQ(body_of(*world).model->system().as_projective()->elements.size(), elements);
}

TEST(Drag, ResetLetsGoAndBeginsAnew) {
  const auto world = hanging(every_model()[0]), other = hanging(every_model()[0]);
  DragEffect& drag = grab_end(*world);
  drag.move_to(drag.center() + Eigen::Vector3d(0, 0, 0.1));
  steps(*world, 10);
  world->reset();
  EXPECT_FALSE(drag.is_holding());
  steps(*world, 10);
  steps(*other, 10);
  EXPECT_EQ(particles_of(*world).x, particles_of(*other).x);
}

TEST(Drag, AStepThatIsUndoneLeavesIt) {
  const auto world = hanging(every_model()[0]), other = hanging(every_model()[0]);
  for (World* each : {world.get(), other.get()}) {
    DragEffect& drag = grab_end(*each);
    drag.move_to(drag.center() + Eigen::Vector3d(0, 0, 0.1));
    steps(*each, 5);
  }
  throw_away(*world);
  EXPECT_FALSE(world->step());
  world->applied_forces().clear();
  steps(*world, 5);
  steps(*other, 5);
  EXPECT_TRUE(drag_of(body_of(*world)).is_holding());
  EXPECT_EQ(particles_of(*world).x, particles_of(*other).x);
}

TEST(Drag, SavedStatesGoOnBitForBit) {
  for (const Dragged& dragged : every_model()) {
    SCOPED_TRACE(dragged.body);
    const auto world = hanging(dragged);
    DragEffect& drag = grab_end(*world);
    drag.move_to(drag.center() + Eigen::Vector3d(0.03, 0, 0.05));
    steps(*world, 5);
    const Checkpoint checkpoint = world->save();
    steps(*world, 10);
    const Positions x = particles_of(*world).x;
    drag.let_go(world->time_step());
    steps(*world, 3);
    world->load(checkpoint);
    EXPECT_TRUE(drag.is_holding());
    steps(*world, 10);
    EXPECT_EQ(particles_of(*world).x, x);
  }
}

TEST(Drag, RefusesBadRequests) {
  const auto world = floating(every_model()[0]);
  Body& body = body_of(*world);
  DragEffect& drag = drag_of(body);
  const Region region = region_to_grab(body, {0, 0, 1}, 0.02);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {-1.0, inf, std::nan("")}) {
    expect_refusal([&] { drag.grab(region, {bad, 0.0}, 0.005); }, {"stiffness", "N/m", ">= 0"});
    expect_refusal([&] { drag.grab(region, {0.0, bad}, 0.005); }, {"limit", "N", ">= 0"});
  }
  Region far = region;
  far.center = {9, 9, 9};
  expect_refusal([&] { drag.grab(far, {}, 0.005); }, {"no vertex that may move"});
  EXPECT_FALSE(drag.is_holding());
  EXPECT_GT(drag.grab(region, {}, 0.005), 1);
  expect_refusal([&] { drag.move_to({0, inf, 0}); }, {"not finite"});
  EXPECT_EQ(drag.target(), drag.center());
  for (int i = 0; i < body.particles().size(); ++i) body.particles().fix(i);
  expect_refusal([&] { region_to_grab(body, {0, 0, 1}, 0.02); }, {"'body'", "may move"});
}

}  // namespace
}  // namespace pliant::drag_test
