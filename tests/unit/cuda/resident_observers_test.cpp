// What observers see of a body that stays on the device: what was read back for them is what the
// whole state shows, and the state is there as soon as anybody needs it.
#include <gtest/gtest.h>

#include <random>

#include "cuda/core/host_executor.h"
#include "cuda/solvers/resident_run/resident_extent.h"
#include "pliant/effects/attachment.h"
#include "support/solvers/device_solvers.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/patch_worlds.h"

namespace pliant::resident_observers_test {
namespace {

void use_device(World& world, const std::string& solver, int iterations = 30) {
  body_of(world).solver = make_host_device_solver(solver, {iterations, 0.0, 0.0});
  world.system_changed();
}

std::unique_ptr<World> draping_cloth(double speed = 0.0) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, 9, 9};
  scene.pose = at(0.02, 0.01, 0.105);
  // Stiff against bending: in a cloth that buckles the last bit decides where to.
  scene.material = {
      {"stretch_warp", "100"}, {"stretch_weft", "100"}, {"shear", "20"}, {"bending", "1e-3"}};
  scene.fixed = {0};
  scene.obstacles = {obstacle(Sphere(0.1))};
  scene.effects = {
      {"gravity", {}}, {"damping", {{"rate", "4"}}}, {"contact", {}}, {"friction", {}}};
  if (speed > 0.0) scene.fixed.clear();
  auto world = make_world(scene);
  use_device(*world, "chebyshev");
  EXPECT_TRUE(world->step());
  particles_of(*world).v.row(0).array() += speed;
  return world;
}

/// A ball of smooth patches that flies and spins far from the origin, past obstacles that it may
/// touch or not.
PatchScene flying_ball(bool touches) {
  PatchScene scene;
  scene.pose = at(1000.0, -2000.0, 0.0501);
  scene.obstacles = {obstacle(Plane()), obstacle(Sphere(0.1), at(1000.2, -2000.0, 0.0))};
  scene.options = {{"tetrahedra", "200"}};
  scene.time_step = 0.001;
  scene.effects = {{"gravity", {}}, {"damping", {}}};
  if (touches) scene.effects.push_back({"contact", {}});
  return scene;
}

std::unique_ptr<World> flying_world(bool touches) {
  auto world = make_world(flying_ball(touches));
  use_device(*world, "chebyshev", 15);
  Particles& p = particles_of(*world);
  const Eigen::Vector3d center = p.center_of_mass(), spin(3.0, 20.0, -8.0);
  for (int i = 0; i < p.size(); ++i) {
    p.v.col(i) = Eigen::Vector3d(1.0, 0.5, 0.0) + spin.cross(p.x.col(i) - center);
  }
  p.v_start = p.v;
  EXPECT_TRUE(world->step());
  return world;
}

struct Seen {
  std::uint64_t step;
  Readback at_hand;
  Positions surface, x, v;
  Eigen::Vector3d force;
};

/// What is seen each 10 of 40 steps on end.
std::vector<Seen> watch(World& world, Readback readback, int steps = 40) {
  std::vector<Seen> seen;
  const auto observe = [&](const World& now) {
    const Body& body = now.bodies().front();
    Positions surface(3, body.model->surface_vertices());
    body.model->surface_positions(surface);
    const Particles& p = body.particles();
    const bool touches = !now.reactions().empty();
    seen.push_back({now.steps(), now.at_hand(), surface, p.x, p.v,
                    touches ? now.reactions()[0].force : Eigen::Vector3d::Zero()});
    return true;
  };
  EXPECT_TRUE(world.advance(steps, 10, observe, [=] { return readback; })) << world.failure();
  EXPECT_EQ(world.at_hand(), Readback::kState);
  return seen;
}

double largest(const Positions& a, const Positions& b) { return (a - b).cwiseAbs().maxCoeff(); }

double size_of(const World& world) {
  const Positions& x = world.bodies().front().particles().x;
  return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

void expect_same_state(const World& a, const World& b) {
  const Particles &p = a.bodies().front().particles(), &q = b.bodies().front().particles();
  EXPECT_EQ(a.steps(), b.steps());
  EXPECT_EQ(a.time(), b.time());
  EXPECT_EQ(p.x, q.x);
  EXPECT_EQ(p.v, q.v);
  EXPECT_EQ(p.x_start, q.x_start);
  EXPECT_EQ(p.v_start, q.v_start);
}

TEST(ResidentObservers, TheSurfaceOfAPatchIsThatOfItsParticles) {
  const auto world = flying_world(false), whole = flying_world(false);
  const Positions before = particles_of(*world).x;
  const std::vector<Seen> seen = watch(*world, Readback::kSurface),
                          all = watch(*whole, Readback::kState);
  ASSERT_EQ(seen.size(), 4u);
  ASSERT_NE(seen[0].surface.cols(), before.cols());
  for (std::size_t k = 0; k < seen.size(); ++k) {
    EXPECT_EQ(seen[k].step, all[k].step);
    EXPECT_EQ(seen[k].at_hand, k < 3 ? Readback::kSurface : Readback::kState);
    if (k < 3) {
      EXPECT_TRUE(seen[k].x == before) << "the state stays";
    }
    // Positions in single precision would be off by 6e-5 here.
    EXPECT_LE(largest(seen[k].surface, all[k].surface), 1e-7 * size_of(*whole)) << k;
    EXPECT_GT(largest(seen[k].surface, seen[(k + 1) % 4].surface), 0.01) << "it moves";
  }
  expect_same_state(*world, *whole);
}

TEST(ResidentObservers, WhatStepsOneByOneIsSeenWhole) {
  const auto world = flying_world(true), whole = flying_world(true);
  const std::vector<Seen> seen = watch(*world, Readback::kSurface, 3),
                          all = watch(*whole, Readback::kState, 3);
  ASSERT_EQ(seen.size(), 3u);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    EXPECT_EQ(seen[k].at_hand, Readback::kState);
    EXPECT_EQ(seen[k].surface, all[k].surface);
  }
  expect_same_state(*world, *whole);
}

TEST(ResidentObservers, ClothIsSeenToTheBitWhateverIsReadBack) {
  const auto whole = draping_cloth();
  const std::vector<Seen> all = watch(*whole, Readback::kState);
  for (const Readback readback : {Readback::kNothing, Readback::kSurface, Readback::kMotion}) {
    const auto world = draping_cloth();
    const Positions before = particles_of(*world).x;
    const std::vector<Seen> seen = watch(*world, readback);
    ASSERT_EQ(seen.size(), all.size());
    for (std::size_t k = 0; k < seen.size(); ++k) {
      EXPECT_EQ(seen[k].at_hand, k < 3 ? readback : Readback::kState);
      EXPECT_EQ(seen[k].force, all[k].force);
      if (readback >= Readback::kSurface) {
        EXPECT_EQ(seen[k].surface, all[k].surface);
      }
      if (readback >= Readback::kMotion) {
        EXPECT_EQ(seen[k].x, all[k].x);
        EXPECT_EQ(seen[k].v, all[k].v);
      } else if (k < 3) {
        EXPECT_EQ(seen[k].x, before);
      }
    }
    EXPECT_GT(all.back().force.norm(), 0.0);
    expect_same_state(*world, *whole);
    EXPECT_EQ(body_of(*world).report.contacts, body_of(*whole).report.contacts);
  }
}

TEST(ResidentObservers, WhatIsHeldIsSeenWithItsMotion) {
  const auto hold = [] {
    auto world = draping_cloth();
    AttachmentRequest request;
    request.name = "corner";
    request.region.kind = Region::Kind::kSphere;
    request.region.center = particles_of(*world).x.col(80);
    request.region.radius = 0.05;
    request.count = particles_of(*world).size();
    request.obstacle = 0;
    request.stiffness = 100.0;
    attachments_of(body_of(*world), world->obstacles()).add(request);
    use_device(*world, "chebyshev");
    EXPECT_TRUE(world->step());
    return world;
  };
  const auto world = hold(), whole = hold();
  const std::vector<Seen> seen = watch(*world, Readback::kNothing),
                          all = watch(*whole, Readback::kState);
  ASSERT_EQ(seen.size(), 4u);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    EXPECT_GE(seen[k].at_hand, Readback::kMotion);
    EXPECT_EQ(seen[k].force, all[k].force);
  }
  expect_same_state(*world, *whole);
}

TEST(ResidentObservers, WhatGoesFarIsUploadedAgainFromItsState) {
  const auto world = draping_cloth(4.0), whole = draping_cloth(4.0);
  const std::vector<Seen> seen = watch(*world, Readback::kSurface, 80),
                          all = watch(*whole, Readback::kState, 80);
  ASSERT_EQ(seen.size(), all.size());
  int times = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    EXPECT_EQ(seen[k].step, all[k].step);
    EXPECT_EQ(seen[k].surface, all[k].surface) << k;
    times += seen[k].at_hand == Readback::kState ? 1 : 0;
  }
  EXPECT_GT(times, 1) << "it never went far";
  EXPECT_LT(times, static_cast<int>(seen.size()));
  expect_same_state(*world, *whole);
}

TEST(ResidentObservers, WhatLeavesAllBoundsGoesBackToWhatWasSeen) {
  std::vector<std::string> failures;
  std::vector<std::unique_ptr<World>> worlds;
  for (const Readback readback : {Readback::kSurface, Readback::kState}) {
    auto world = draping_cloth(0.9);
    world->finite_check().max_speed = 1.5;  // of a body that falls past the ball
    const auto observe = [](const World&) { return true; };
    EXPECT_FALSE(world->advance(200, 10, observe, [=] { return readback; }));
    failures.push_back(world->failure());
    worlds.push_back(std::move(world));
  }
  EXPECT_FALSE(failures[0].empty());
  EXPECT_EQ(failures[0], failures[1]);
  EXPECT_GT(worlds[0]->steps(), 20u) << "no resident run followed another";
  expect_same_state(*worlds[0], *worlds[1]);
}

TEST(ResidentObservers, TheStateIsThereWhereAnObserverEndsTheRun) {
  const auto exact = draping_cloth();
  watch(*exact, Readback::kState, 20);
  for (const bool throws : {false, true}) {
    const auto world = draping_cloth();
    int observations = 0;
    const auto observe = [&](const World&) {
      if (++observations == 2 && throws) throw std::runtime_error("disk full");
      return observations < 2;
    };
    const auto go = [&] {
      return world->advance(40, 10, observe, [] { return Readback::kSurface; });
    };
    if (throws) {
      EXPECT_THROW(go(), std::runtime_error);
    } else {
      EXPECT_TRUE(go());
    }
    EXPECT_EQ(world->at_hand(), Readback::kState);
    expect_same_state(*world, *exact);
    EXPECT_EQ(body_of(*world).model->surface().vertices, particles_of(*exact).x);
  }
}

/// A device that is lost in its third resident run, or when its state is to be read back.
class LosesState final : public Solver {
 public:
  explicit LosesState(int runs) : runs_(runs) {}
  std::string_view name() const override { return "jacobi"; }
  void prepare(System& system, double dt) override { solver_->prepare(system, dt); }
  void step(System& system, double dt, StepReport& report) override {
    solver_->step(system, dt, report);
  }
  int resident_limit(const System& system, const ResidentRun& run) override {
    return solver_->resident_limit(system, run);
  }
  void begin_resident_run(System& system, const ResidentRun& run, StepReport& report) override {
    solver_->begin_resident_run(system, run, report);
  }
  int finish_resident_run(System& system, std::vector<Reaction>& reactions,
                          StepReport& report) override {
    if (--runs_ < 0) throw DeviceFailure("device lost");
    return solver_->finish_resident_run(system, reactions, report);
  }
  Readback available() const override { return solver_->available(); }
  const Positions* seen_surface() const override { return solver_->seen_surface(); }
  bool read_back_state(System&) override { throw DeviceFailure("device lost"); }

 private:
  std::unique_ptr<Solver> solver_ = make_host_device_solver("jacobi", {60, 0.0, 0.0});
  int runs_;
};

TEST(ResidentObservers, ALostDeviceCostsTimeAlone) {
  const auto make = [](int runs, Readback readback, int observations) {
    auto world = draping_cloth();
    body_of(*world).solver = with_fallback(
        "cuda", make_solver("jacobi", {{"iterations", "60"}}),
        [=](SolverBatch*) { return std::make_unique<LosesState>(runs); }, 60);
    world->system_changed();
    std::vector<std::uint64_t> steps;
    const auto observe = [&](const World& now) {
      steps.push_back(now.steps());
      return static_cast<int>(steps.size()) < observations;
    };
    EXPECT_TRUE(world->advance(40, 10, observe, [=] { return readback; })) << world->failure();
    for (std::size_t k = 1; k < steps.size(); ++k) EXPECT_GT(steps[k], steps[k - 1]);
    EXPECT_EQ(steps.back(), world->steps());
    EXPECT_EQ(world->time(), static_cast<double>(world->steps()) * world->time_step());
    return world;
  };
  for (const auto& [runs, observations] : {std::pair{2, 1000}, std::pair{1000, 2}}) {
    // Nothing is lost of what is read back for each observation but in a run under way.
    const auto whole = make(runs, Readback::kState, observations);
    for (const Readback readback : {Readback::kSurface, Readback::kMotion}) {
      const auto world = make(runs, readback, observations);
      EXPECT_EQ(world->steps(), whole->steps());
      EXPECT_LE(largest(particles_of(*world).x, particles_of(*whole).x), 1e-3 * size_of(*whole))
          << runs;
    }
  }
}

TEST(ResidentObservers, ExtentsAreThoseOfAllParticles) {
  constexpr int kCount = 2 * FindExtent::kRun + 77;
  std::mt19937 random(3);
  std::uniform_int_distribution<int> place(-(1 << 28), 1 << 28);
  std::uniform_real_distribution<float> speed(-1e4f, 1e4f);
  std::vector<Fixed> x(kCount);
  std::vector<Float4> displacements(kCount);
  ResidentExtent expected = {{0, 0, 0}, {0, 0, 0}, 0.0f};
  for (int i = 0; i < kCount; ++i) {
    const auto k = static_cast<std::size_t>(i);
    x[k] = {place(random) + (1 << 29), place(random), place(random), 0.0f};
    displacements[k] = {speed(random), speed(random), speed(random), 1e6f};
    const ResidentExtent own = {
        {x[k].x, x[k].y, x[k].z},
        {x[k].x, x[k].y, x[k].z},
        std::max({std::abs(displacements[k].x), std::abs(displacements[k].y),
                  std::abs(displacements[k].z)})};
    if (i == 0) expected = own;
    expected.add(own);
  }
  std::vector<ResidentExtent> runs(3);
  HostExecutor executor;
  executor.launch_blocks(3, FindExtent::kThreads, FindExtent::kFloats,
                         FindExtent{x.data(), displacements.data(), kCount, runs.data()});
  ResidentExtent found = runs[0];
  for (const ResidentExtent& run : runs) found.add(run);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(found.low[k], expected.low[k]);
    EXPECT_EQ(found.high[k], expected.high[k]);
  }
  EXPECT_GT(found.low[0], 0);
  EXPECT_EQ(found.fastest, expected.fastest);
}

}  // namespace
}  // namespace pliant::resident_observers_test
