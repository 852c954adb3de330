// Bodies of particles on a GPU against the CPU: clusters within the iterations, and the liquid.
#include <gtest/gtest.h>

#include "cuda/brief.h"
#include "cuda/on_gpu.h"
#include "cuda/skip_without_gpu.h"
#include "pliant/core/step/step_report.h"
#include "pliant/effects/particles/heat.h"
#include "pliant/models/viscoelastic/liquid_device.h"
#include "support/worlds/liquid_sample.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

TEST(LiquidOnGpu, HasTheForcesOfTheCpuAndRepeatsThem) {
  PLIANT_SKIP_WITHOUT_GPU();
  const LiquidSample sample;
  Liquid cpu, gpu;
  sample.add_to(cpu);
  sample.add_to(gpu);
  gpu.set_device(make_cuda_liquid());
  StepReport report;
  const auto forces = [&](Liquid& liquid) {
    report.begin(1, 0.0, 0.001);
    Forces f = Forces::Zero(3, sample.particles.size());
    liquid.add_forces(sample.particles, sample.beta, nullptr, f, report);
    return f;
  };
  const Forces exact = forces(cpu), found = forces(gpu);
  ASSERT_TRUE(gpu.has_device());
  const double largest = exact.colwise().norm().maxCoeff();
  EXPECT_LE((found - exact).colwise().norm().maxCoeff(), 10 * 33 * 6e-8 * largest);
  EXPECT_EQ(forces(gpu), found);
  EXPECT_LE(found.rowwise().sum().norm(), 6e-8 * found.colwise().norm().sum());
}

struct Scene {
  std::string name;
  double beta;
  double viscosity;  // [Pa s]
  bool oriented = false;
};

class ParticlesOnGpu : public testing::TestWithParam<Scene> {
 protected:
  static constexpr double kSize = 0.1;  // [m]

  static std::unique_ptr<ParticleWorld> make(const ParameterText& parameters,
                                             bool has_heat = true) {
    ViscoelasticModel::Material material;
    material.beta = GetParam().beta;
    material.liquid.viscosity = GetParam().viscosity;
    material.oriented = GetParam().oriented;
    auto world =
        std::make_unique<ParticleWorld>(sampled_box({kSize, kSize, 0.06}, 0.0125), material, 0.002);
    world->model().place(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.035)));
    Obstacle plane;
    plane.name = "plane";
    plane.shape = std::make_shared<Plane>();
    plane.pose_start = plane.pose_end = Eigen::Isometry3d::Identity();
    world->world().add_obstacle(plane);
    for (const char* effect : {"gravity", "contact", "friction"}) world->add_effect(effect);
    if (GetParam().beta > 0.0) {
      world->add_effect("xsph");
      world->add_effect("surface_tension");
    }
    if (GetParam().beta > 0.0 && has_heat) {
      // The air warms it, but melts nothing.
      world->add_effect("heat", {{"solid_beta", std::to_string(GetParam().beta)},
                                 {"air_temperature", "300"},
                                 {"convection", "1e4"},
                                 {"conductivity", "50"}});
    }
    world->start("chebyshev", parameters);
    return world;
  }
};

const Eigen::VectorXd& temperatures(ParticleWorld& world) {
  return dynamic_cast<HeatEffect&>(*world.body().find_effect("heat")).temperatures();
}

INSTANTIATE_TEST_SUITE_P(Scenes, ParticlesOnGpu,
                         testing::Values(Scene{"Elastic", 0.0, 0.1},
                                         Scene{"Oriented", 0.0, 0.1, true},
                                         Scene{"Viscoelastic", 0.5, 2.0}),
                         [](const auto& info) { return info.param.name; });

const ParameterText kGpu = on_gpu(times(300, 8), {{"tolerance", "1e-6"}});

TEST_P(ParticlesOnGpu, TwoHundredStepsTakeThePathOfTheCpu) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto gpu = make(kGpu), cpu = make({{"iterations", "500"}, {"tolerance", "1e-8"}});
  int contacts = 0;
  double largest = 0.0;
  for (int s = 0; s < times(200, 40); ++s) {
    ASSERT_TRUE(cpu->world().step()) << cpu->world().failure();
    ASSERT_TRUE(gpu->world().step()) << gpu->world().failure();
    ASSERT_EQ(gpu->body().report.backend, "cuda");
    ASSERT_TRUE(gpu->model().system().liquid.has_device());
    contacts = std::max(contacts, cpu->body().report.contacts);
    largest = std::max(
        largest, (cpu->particles().x - gpu->particles().x).colwise().norm().maxCoeff() / kSize);
  }
  std::printf("largest distance %.2e of the body's size, on %s\n", largest, gpu_name().c_str());
  // The walls of a liquid hold it off.
  EXPECT_EQ(contacts > 3, GetParam().beta == 0.0);
  PLIANT_END_IF_BRIEF();
  EXPECT_LE(largest, 1e-4);
  if (GetParam().beta > 0.0) {
    const Eigen::VectorXd &exact = temperatures(*cpu), &found = temperatures(*gpu);
    const double range = exact.maxCoeff() - exact.minCoeff();
    EXPECT_GT(range, 0.1);
    EXPECT_LE((found - exact).cwiseAbs().maxCoeff(), 1e-3 * range);
  }
}

TEST_P(ParticlesOnGpu, RunsRepeatBitForBit) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto first = make(kGpu), second = make(kGpu);
  for (int s = 0; s < times(50, 25); ++s) {
    ASSERT_TRUE(first->world().step());
    ASSERT_TRUE(second->world().step());
  }
  EXPECT_EQ(first->particles().x, second->particles().x);
  EXPECT_EQ(first->particles().v, second->particles().v);
}

TEST_P(ParticlesOnGpu, ResidentRunsTakeTheirPathAndRepeat) {
  PLIANT_SKIP_WITHOUT_GPU();
  const int steps = times(100, 25);
  const auto single = make(kGpu, false);
  for (int s = 0; s <= steps; ++s) ASSERT_TRUE(single->world().step());
  std::vector<Positions> ends;
  for (int run = 0; run < 2; ++run) {
    const auto resident = make(kGpu, false);
    ASSERT_TRUE(resident->world().step());
    // Orientations follow the particles on the CPU, after each step.
    if (GetParam().oriented) {
      EXPECT_LT(resident->world().resident_limit(steps), 2);
      return;
    }
    ASSERT_GE(resident->world().resident_limit(steps), 2);
    ASSERT_TRUE(resident->world().advance(steps));
    EXPECT_EQ(resident->world().steps(), single->world().steps());
    EXPECT_EQ(resident->body().report.backend, "cuda");
    EXPECT_LE((resident->particles().x - single->particles().x).colwise().norm().maxCoeff(),
              1e-4 * kSize);
    const Eigen::Vector3d force = single->world().reactions()[0].force;
    const double weight = 9.81 * resident->particles().mass.sum();
    EXPECT_LE((resident->world().reactions()[0].force - force).norm(), 0.05 * weight);
    ends.push_back(resident->particles().x);
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST_P(ParticlesOnGpu, SwapsBetweenBackendsKeepTheState) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto world = make({});
  for (const char* backend : {"cuda", "cpu", "cuda"}) {
    for (int s = 0; s < 5; ++s) ASSERT_TRUE(world->world().step());
    const Particles before = world->particles();
    world->world().set_solver(world->body(), all_solvers(), "chebyshev", {{"backend", backend}},
                              "test");
    EXPECT_EQ(world->particles().x, before.x);
    ASSERT_TRUE(world->world().step());
    EXPECT_EQ(world->body().report.backend, backend);
  }
}

TEST(SurfaceOnGpu, HasTheTrianglesOfTheCpuAndRepeatsThem) {
  PLIANT_SKIP_WITHOUT_GPU();
  const InteriorSamples ball = sample_interior(Sphere(0.1).surface(), 0.006);
  const auto n = static_cast<double>(ball.points.cols());
  const Eigen::VectorXd volumes = Eigen::VectorXd::Constant(ball.points.cols(), ball.volume / n);
  const SurfaceStyle style = {2.0 * std::cbrt(volumes[0]), 2, false};
  ParticleSurface cpu, gpu;
  gpu.set_device(make_cuda_surface());
  cpu.update(ball.points, volumes, style);
  gpu.update(ball.points, volumes, style);
  ASSERT_TRUE(gpu.has_device());
  const TriangleMesh found = gpu.mesh();
  ASSERT_EQ(found.triangles, cpu.mesh().triangles);
  EXPECT_LE((found.vertices - cpu.mesh().vertices).colwise().norm().maxCoeff(),
            2e-5 * style.support);
  gpu.update(ball.points, volumes, style);
  EXPECT_EQ(gpu.mesh().vertices, found.vertices);
}

}  // namespace
}  // namespace pliant
