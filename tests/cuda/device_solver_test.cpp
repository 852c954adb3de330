// The CUDA backend on a GPU against the solvers of the CPU.
#include <gtest/gtest.h>

#include "cuda/brief.h"
#include "cuda/on_gpu.h"
#include "cuda/skip_without_gpu.h"
#include "cuda/solvers/scenes/packed_system.h"
#include "pliant/geometry/distance/mesh_shape.h"
#include "pliant/solvers/device/solver_batch.h"
#include "support/meshes/intersections.h"
#include "support/solvers/projective_model.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/crumpling_sheet.h"
#include "support/worlds/patch_worlds.h"

namespace pliant {
namespace {

using MakeWorld = std::function<std::unique_ptr<World>(const std::string&, const ParameterText&)>;

std::unique_ptr<World> cloth_on(const Obstacle& ball, const std::string& solver,
                                const ParameterText& parameters) {
  ClothScene scene;
  // Stiff against bending and damped: in a cloth that buckles the last bit decides where to.
  scene.grid = {0.3, 0.3, 13, 13};
  scene.pose = at(0.02, 0.01, 0.105);
  scene.material = {
      {"stretch_warp", "100"}, {"stretch_weft", "100"}, {"shear", "20"}, {"bending", "1e-3"}};
  scene.obstacles = {ball, obstacle(Plane(), at(0, 0, -0.05))};
  scene.effects = {{"gravity", {}},
                   {"damping", {{"rate", "4"}}},
                   {"contact", {}},
                   {"friction", {{"coefficient", "0.8"}}}};
  scene.solver = solver;
  scene.solver_parameters = parameters;
  return make_world(scene);
}

std::unique_ptr<World> cloth_on_ball(const std::string& solver, const ParameterText& parameters) {
  return cloth_on(obstacle(Sphere(0.1)), solver, parameters);
}

std::unique_ptr<World> cloth_on_mesh(const std::string& solver, const ParameterText& parameters) {
  return cloth_on(obstacle(MeshShape(Sphere(0.1).surface())), solver, parameters);
}

std::unique_ptr<World> ball_on_plane(const std::string& solver, const ParameterText& parameters) {
  return make_world(falling_ball(solver, parameters));
}

struct Scene {
  std::string name;
  MakeWorld make;
};

class OnGpu : public testing::TestWithParam<Scene> {};
INSTANTIATE_TEST_SUITE_P(Scenes, OnGpu,
                         testing::Values(Scene{"ClothOnBall", cloth_on_ball},
                                         Scene{"FallingBall", ball_on_plane}),
                         [](const auto& info) { return info.param.name; });

/// Enough that a spectral radius is found, which is what steps on end need.
constexpr int kFew = 8;

const ParameterText kTolerance = {{"tolerance", "1e-6"}};
const ParameterText kGpu = on_gpu(times(600, kFew), kTolerance);

TEST_P(OnGpu, TwoHundredStepsTakeThePathOfTheCpu) {
  PLIANT_SKIP_WITHOUT_GPU();
  // Where the ball meets the plane 600 iterations leave 1e-6 of its size, and a ball that is about
  // to roll multiplies it.
  const auto gpu = GetParam().make("chebyshev", on_gpu(times(2000, kFew), kTolerance));
  const auto cpu = GetParam().make("chebyshev", {{"iterations", "4000"}, {"tolerance", "1e-8"}});
  const Positions& x = particles_of(*cpu).x;
  const double size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
  int contacts = 0;
  double largest = 0.0;
  for (int s = 0; s < times(200, 40); ++s) {
    ASSERT_TRUE(cpu->step()) << cpu->failure();
    ASSERT_TRUE(gpu->step()) << gpu->failure();
    ASSERT_EQ(body_of(*gpu).report.backend, "cuda");
    contacts = std::max(contacts, body_of(*cpu).report.contacts);
    largest = std::max(largest, (x - particles_of(*gpu).x).colwise().norm().maxCoeff() / size);
  }
  std::printf("largest distance %.2e of the body's size, on %s\n", largest, gpu_name().c_str());
  EXPECT_GT(contacts, 3);
  PLIANT_END_IF_BRIEF();
  EXPECT_LE(largest, 1e-4);
  const Energies a = cpu->energies(), b = gpu->energies();
  std::printf("elastic energy %.6e and %.6e J\n", a.elastic, b.elastic);
  EXPECT_NEAR(b.elastic, a.elastic, 1e-3 * a.elastic);
}

TEST_P(OnGpu, OneStepReachesTheMinimumOfTheCpu) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto cpu = GetParam().make("chebyshev", {{"iterations", "4000"}, {"tolerance", "1e-8"}});
  for (int s = 0; s < 30; ++s) ASSERT_TRUE(cpu->step()) << cpu->failure();
  const auto gpu = GetParam().make("chebyshev", kGpu);
  particles_of(*gpu) = particles_of(*cpu);
  ASSERT_TRUE(cpu->step());
  ASSERT_TRUE(gpu->step());
  PLIANT_END_IF_BRIEF();
  const auto value = [](const World& world) {
    return objective_after(projective_system(*world.bodies()[0].model), world.time_step());
  };
  EXPECT_NEAR(value(*gpu), value(*cpu), 1e-5 * value(*cpu));
}

TEST_P(OnGpu, RunsRepeatBitForBit) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto first = GetParam().make("chebyshev", kGpu),
             second = GetParam().make("chebyshev", kGpu);
  for (int s = 0; s < times(50, 25); ++s) {
    ASSERT_TRUE(first->step());
    ASSERT_TRUE(second->step());
  }
  EXPECT_EQ(particles_of(*first).x, particles_of(*second).x);
  EXPECT_EQ(particles_of(*first).v, particles_of(*second).v);
}

class ResidentRunOnGpuOver : public testing::TestWithParam<Scene> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ResidentRunOnGpuOver,
                         testing::Values(Scene{"Ball", cloth_on_ball},
                                         Scene{"Mesh", cloth_on_mesh}),
                         [](const auto& info) { return info.param.name; });

TEST_P(ResidentRunOnGpuOver, StepsOnEndAreThoseOneByOne) {
  PLIANT_SKIP_WITHOUT_GPU();
  std::vector<Positions> ends;
  for (int run = 0; run < 2; ++run) {
    const auto single = GetParam().make("chebyshev", kGpu);
    const auto resident = GetParam().make("chebyshev", kGpu);
    ASSERT_TRUE(single->step());
    ASSERT_TRUE(resident->step());
    const int steps = times(100, 25);
    EXPECT_GE(resident->resident_limit(steps), 2);
    for (int k = 0; k < steps; ++k) ASSERT_TRUE(single->step());
    ASSERT_TRUE(resident->advance(steps));
    EXPECT_EQ(resident->steps(), single->steps());
    EXPECT_EQ(body_of(*resident).report.backend, "cuda");
    const Positions& x = particles_of(*single).x;
    const double size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
    EXPECT_GT(body_of(*resident).report.contacts, 3);
    ends.push_back(particles_of(*resident).x);
    // So few iterations leave what hangs on where they begin.
    if (is_brief()) continue;
    EXPECT_LE((particles_of(*resident).x - x).colwise().norm().maxCoeff(), 1e-4 * size);
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(ResidentRunOnGpu, FewIterationsLetAStiffClothSlideAsItShould) {
  PLIANT_SKIP_WITHOUT_GPU();
  constexpr int kSteps = 40;
  constexpr double kExact = 9.81 * (0.6 - 0.5 * 0.8);  // [m/s²]
  const Eigen::Isometry3d tilted(Eigen::AngleAxisd(std::atan(0.75), Eigen::Vector3d::UnitY()));
  for (const char* solver : {"jacobi", "chebyshev", "hybrid", "lbfgs"}) {
    ClothScene scene;
    scene.grid = {0.3, 0.3, 33, 33};
    scene.pose = tilted * at(0, 0, 0.0105);
    scene.material = {
        {"stretch_warp", "1e4"}, {"stretch_weft", "1e4"}, {"shear", "1e3"}, {"bending", "1e-3"}};
    scene.obstacles = {obstacle(Plane(), tilted)};
    scene.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {{"coefficient", "0.5"}}}};
    scene.solver = solver;
    scene.solver_parameters = on_gpu(5);
    const auto world = make_world(scene);
    ASSERT_TRUE(world->step());
    const auto velocity = [&]() -> Eigen::Vector3d {
      const Particles& p = particles_of(*world);
      return p.v * p.mass / p.mass.sum();
    };
    ASSERT_GE(world->resident_limit(kSteps), 2) << solver;
    ASSERT_TRUE(world->advance(kSteps));
    const Eigen::Vector3d before = velocity();
    ASSERT_TRUE(world->advance(kSteps));
    EXPECT_EQ(body_of(*world).report.backend, "cuda");
    const double acceleration = (velocity() - before).norm() / (kSteps * world->time_step());
    std::printf("%s: %.4f of the exact acceleration\n", solver, acceleration / kExact);
    EXPECT_NEAR(acceleration, kExact, 0.02 * kExact) << solver;
  }
}

TEST_P(OnGpu, SwapsBetweenBackendsKeepTheState) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto world = GetParam().make("chebyshev", {});
  for (const char* backend : {"cuda", "cpu", "cuda"}) {
    for (int s = 0; s < 5; ++s) ASSERT_TRUE(world->step());
    const Particles before = particles_of(*world);
    world->set_solver(body_of(*world), solver_registry(), "chebyshev", {{"backend", backend}},
                      "test");
    EXPECT_EQ(particles_of(*world).x, before.x);
    EXPECT_EQ(particles_of(*world).v, before.v);
    ASSERT_TRUE(world->step());
    EXPECT_EQ(body_of(*world).report.backend, backend);
  }
}

TEST(SelfContactOnGpu, AFallingSheetCrumplesAndDoesNotPass) {
  PLIANT_SKIP_WITHOUT_GPU();
  ClothScene scene = crumpling_sheet();
  scene.solver = "chebyshev";
  scene.solver_parameters = on_gpu(times(30, 6));
  std::vector<Positions> ends;
  for (int run = 0; run < 2; ++run) {
    const auto world = make_world(scene);
    const Body& body = body_of(*world);
    for (int step = 1; step <= times(160, 60); ++step) {
      ASSERT_TRUE(world->step()) << world->failure();
      ASSERT_EQ(body.report.backend, "cuda");
      if (step % 20 != 0) continue;
      EXPECT_EQ(count_intersections(body.particles().x, body.model->surface_triangles()), 0);
    }
    ends.push_back(body.particles().x);
    if (is_brief()) continue;
    EXPECT_LT(ends.back().row(2).maxCoeff(), 0.15) << "it still stands";
  }
  EXPECT_EQ(ends[0], ends[1]);
}

/// A cloth of `nodes` x `nodes` that falls on a ball and the ground: ever more contacts.
std::unique_ptr<World> draping_cloth(int nodes, double radius) {
  ClothScene scene;
  scene.grid = {0.5, 0.5, nodes, nodes};
  scene.pose = at(0.01, 0.0, radius + 0.01);
  scene.obstacles = {obstacle(Sphere(radius)), obstacle(Plane(), at(0, 0, -0.05))};
  scene.effects = {{"gravity", {}}, {"damping", {}}, {"contact", {}}, {"friction", {}}};
  scene.solver = "chebyshev";
  scene.solver_parameters = on_gpu(times(20, kFew));
  return make_world(scene);
}

TEST(ResidentRunOnGpu, WhatIsSeenIsWhatNoStepUnderWayChanges) {
  PLIANT_SKIP_WITHOUT_GPU();
  for (const char* solver : {"chebyshev", "lbfgs"}) {
    const auto begin = [solver] {
      auto world = draping_cloth(times(100, 40), 0.15);
      world->set_solver(body_of(*world), solver_registry(), solver, on_gpu(times(20, kFew)),
                        "test");
      EXPECT_TRUE(world->step());
      return world;
    };
    std::vector<Particles> seen;
    const auto world = begin();
    const auto observe = [&](const World& now) {
      seen.push_back(now.bodies().front().particles());
      return true;
    };
    const int observations = times(10, 3), each = times(6, 3);
    ASSERT_TRUE(world->advance(observations * each, each, observe));
    ASSERT_EQ(static_cast<int>(seen.size()), observations);
    EXPECT_EQ(body_of(*world).report.backend, "cuda");
    for (const int k : {0, observations / 3, observations - 2}) {
      // Downloaded with nothing under way.
      const auto alone = begin();
      ASSERT_TRUE(alone->advance(each * (k + 1), each, [](const World&) { return true; }));
      const Particles& then = seen[static_cast<std::size_t>(k)];
      EXPECT_EQ(then.x, particles_of(*alone).x) << solver << " " << k;
      EXPECT_EQ(then.v, particles_of(*alone).v);
    }
  }
}

TEST(ResidentRunOnGpu, TheSurfaceOfAPatchIsThatOfItsParticles) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto watch = [](Readback readback, std::vector<Positions>& surfaces) {
    PatchScene scene;
    scene.options = {{"tetrahedra", std::to_string(times(20000, 1500))}};
    scene.pose = at(1000.0, -2000.0, 0.5);
    scene.effects = {{"gravity", {}}, {"damping", {}}};
    scene.obstacles = {obstacle(Plane())};
    scene.time_step = 0.001;  // it goes less than its size in the steps of two observations
    scene.solver = "chebyshev";
    scene.solver_parameters = on_gpu(times(20, kFew));
    auto world = make_world(scene);
    // It spins: a body in free fall has no radius that steps on end could go on with.
    Particles& p = particles_of(*world);
    const Eigen::Vector3d center = p.center_of_mass(), spin(3.0, 20.0, -8.0);
    for (int n = 0; n < p.size(); ++n) {
      p.v.col(n) = Eigen::Vector3d(1.0, 0.5, 0.0) + spin.cross(p.x.col(n) - center);
    }
    p.v_start = p.v;
    EXPECT_TRUE(world->step());
    const auto observe = [&](const World& now) {
      surfaces.push_back(now.bodies().front().model->surface().vertices);
      EXPECT_EQ(now.at_hand(), surfaces.size() < 6 ? readback : Readback::kState);
      return true;
    };
    const int each = times(5, 2);
    EXPECT_TRUE(world->advance(6 * each, each, observe, [=] { return readback; }));
    return world;
  };
  std::vector<Positions> seen, all;
  const auto world = watch(Readback::kSurface, seen), whole = watch(Readback::kState, all);
  ASSERT_EQ(seen.size(), 6u);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    // The ball's size is 0.1 m; positions in single precision would be off by 6e-5 m.
    EXPECT_LE((seen[k] - all[k]).cwiseAbs().maxCoeff(), 1e-8) << k;
  }
  EXPECT_EQ(particles_of(*world).x, particles_of(*whole).x);
  EXPECT_EQ(particles_of(*world).v_start, particles_of(*whole).v_start);
}

TEST(ResidentRunOnGpu, WhatIsSeenIsThereWhateverIsReadBack) {
  PLIANT_SKIP_WITHOUT_GPU();
  std::map<Readback, std::vector<Positions>> seen;
  std::map<Readback, Positions> ends;
  for (const Readback readback :
       {Readback::kNothing, Readback::kSurface, Readback::kMotion, Readback::kState}) {
    const auto world = draping_cloth(times(100, 40), 0.15);
    ASSERT_TRUE(world->step());
    const int each = times(6, 2);
    const auto observe = [&](const World& now) {
      seen[readback].push_back(now.bodies().front().model->surface().vertices);
      return true;
    };
    ASSERT_TRUE(world->advance(10 * each, each, observe, [=] { return readback; }));
    ends[readback] = particles_of(*world).x;
  }
  for (const Readback readback : {Readback::kNothing, Readback::kSurface, Readback::kMotion}) {
    EXPECT_EQ(ends[readback], ends[Readback::kState]);
    if (readback != Readback::kNothing) {
      EXPECT_EQ(seen[readback], seen[Readback::kState]);
    }
  }
}

TEST(ResidentRunOnGpu, WhatIsNotANumberIsUndone) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto world = cloth_on_ball("jacobi", {{"iterations", "5"}, {"backend", "cuda"}});
  ASSERT_TRUE(world->step());
  particles_of(*world).v(0, 0) = std::nan("");
  const Positions before = particles_of(*world).x;
  EXPECT_FALSE(world->advance(8));
  EXPECT_EQ(particles_of(*world).x, before);
  EXPECT_NE(world->failure().find("vertex 0"), std::string::npos) << world->failure();
}

class OnGpuProblem : public testing::TestWithParam<StepProblem> {};
INSTANTIATE_TEST_SUITE_P(Problems, OnGpuProblem, testing::ValuesIn(step_problems()), problem_name);

TEST_P(OnGpuProblem, MeetsTheConvergedStep) {
  PLIANT_SKIP_WITHOUT_GPU();
  const StepProblem& problem = GetParam();
  const ProjectiveSystem exact = after_converged_step(problem);
  const double distance = (exact.particles.x - exact.particles.x_start).norm();
  // Left to itself "auto" would take the CPU for so few particles.
  const bool is_taken = why_not_packed(problem.make()).empty();
  for (const char* name :
       {"jacobi", "line_search_jacobi", "gauss_seidel", "hybrid", "chebyshev", "lbfgs"}) {
    ProjectiveSystem system = problem.make();
    const auto solver = make_solver(name, {{"iterations", std::to_string(times(5000, 10))},
                                           {"backend", is_taken ? "cuda" : "auto"}});
    solver->prepare(system, problem.dt);
    EXPECT_EQ(step_of(system, *solver, problem.dt).backend, is_taken ? "cuda" : "cpu") << name;
    if (is_brief()) continue;
    EXPECT_LE((system.particles.x - exact.particles.x).norm(), 1e-4 * distance) << name;
  }
}

TEST(BatchOnGpu, EachSceneDoesWhatItDoesAlone) {
  PLIANT_SKIP_WITHOUT_GPU();
  // Memory grows with the contacts, in every order: no graph may keep what was let go.
  const std::vector<int> nodes = {9, 12, 20, 33};
  std::vector<std::unique_ptr<World>> together, alone;
  const auto batch = make_cuda_batch();
  for (int count : nodes) {
    const double radius = 0.1 + 0.002 * count;
    together.push_back(draping_cloth(count, radius));
    alone.push_back(draping_cloth(count, radius));
    ASSERT_TRUE(body_of(*together.back()).solver->join(*batch));
    together.back()->system_changed();
    alone.back()->system_changed();
  }
  for (int step = 0; step < times(120, 30); ++step) {
    for (const auto& world : together) world->begin_step();
    batch->run();
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      ASSERT_TRUE(together[s]->finish_step()) << together[s]->failure();
      ASSERT_TRUE(alone[s]->step()) << alone[s]->failure();
      ASSERT_EQ(body_of(*together[s]).report.backend, "cuda") << nodes[s] << " at " << step;
      ASSERT_EQ(body_of(*alone[s]).report.backend, "cuda") << nodes[s] << " at " << step;
      ASSERT_EQ(particles_of(*together[s]).x, particles_of(*alone[s]).x)
          << nodes[s] << " at " << step;
    }
  }
  for (const auto& world : together) EXPECT_GT(body_of(*world).report.contacts, times(5, 2));
  together.clear();  // before the batch
}

}  // namespace
}  // namespace pliant
