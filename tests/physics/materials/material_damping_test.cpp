// Viscosity of materials: what it damps, how much, and what it leaves alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/solvers/time/time_integrations.h"
#include "support/measures.h"
#include "support/worlds/patch_worlds.h"
#include "support/worlds/worlds.h"

namespace pliant::material_damping_test {
namespace {

const ParameterText kConverged = {{"iterations", "30"}, {"tolerance", "1e-10"}};

void integrate_by(World& world, const std::string& name) {
  world.set_time_integration(body_of(world), time_integrations(), name);
}

PatchScene bar(const std::string& damping, double dt) {
  PatchScene scene;
  scene.kind = "block";
  // Twice as broad as high, so that it does not swing sideways.
  scene.size = {{"size", "[0.2, 0.08, 0.04]"}, {"cells", "[5, 2, 1]"}};
  scene.options = {{"contact_spacing", "0.1"}};
  scene.material = {{"young", "1e5"}, {"poisson", "0.3"}, {"density", "500"}, {"damping", damping}};
  scene.solver = "newton";
  scene.solver_parameters = kConverged;
  scene.time_step = dt;
  return scene;
}

struct Decay {
  double frequency = 0.0;  ///< circular [1/s]
  double decrement = 0.0;  ///< logarithmic, of a period
};

/// Of the swing of the particle `tip` in z about 0: from the times at which it passes and its
/// largest values between these, once what swings faster has died away.
Decay decay_of(World& world, int tip) {
  const Particles& p = particles_of(world);
  std::vector<double> passes, peaks;
  double last = 0.0, peak = 0.0;
  while (passes.size() < 6) {
    EXPECT_TRUE(world.step());
    const double z = p.x(2, tip);
    const double dt = world.time_step();
    if (last != 0.0 && (last > 0.0) != (z > 0.0)) {
      passes.push_back(world.time() - dt * z / (z - last));
      peaks.push_back(peak);
      peak = 0.0;
    }
    peak = std::max(peak, std::abs(z));
    last = z;
    if (world.time() > 20.0) {
      ADD_FAILURE() << "it does not swing";
      return {};
    }
  }
  // A period has two passes.
  return {2.0 * M_PI / (passes[5] - passes[3]), std::log(peaks[3] / peaks[5])};
}

Decay swing(const PatchScene& scene, const std::string& integration) {
  auto world = make_world(scene);
  Particles& p = particles_of(*world);
  int tip = 0;
  for (int i = 0; i < p.size(); ++i) {
    const double along = p.x(0, i) + 0.1;
    if (along < 1e-6) p.fix(i);
    if (p.x(0, i) > p.x(0, tip)) tip = i;
    p.v.col(i) << 0.0, 0.0, 0.5 * along * along;
  }
  p.x.row(2).array() -= p.x(2, tip);
  world->system_changed();
  integrate_by(*world, integration);
  return decay_of(*world, tip);
}

/// Closed form for a linear mode of stiffness-proportional damping: ζ = β ω/2.
double expected_decrement(double beta, double damped_frequency) {
  // ω_d = ω √(1 − ζ²)
  double zeta = 0.5 * beta * damped_frequency;
  for (int k = 0; k < 20; ++k) {
    zeta = 0.5 * beta * damped_frequency / std::sqrt(1.0 - zeta * zeta);
  }
  return 2.0 * M_PI * zeta / std::sqrt(1.0 - zeta * zeta);
}

class DampedSecondOrder : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Both, DampedSecondOrder, testing::Values("bdf2", "midpoint"),
                         test_name_of);

TEST_P(DampedSecondOrder, ASwingingBarDecaysAsTheMaterialSays) {
  for (const char* strain : {"tetrahedra", "averaged"}) {
    for (const char* damping : {"0.005", "0.02"}) {
      PatchScene scene = bar(damping, 4e-3);
      scene.material["strain"] = strain;
      const Decay decay = swing(scene, GetParam());
      const double expected = expected_decrement(std::stod(damping), decay.frequency);
      EXPECT_NEAR(decay.decrement / expected, 1.0, 0.03) << strain << damping;
    }
  }
}

TEST(DampedImplicitEuler, DampsMoreThanTheMaterialAtLargeSteps) {
  const Decay decay = swing(bar("0.005", 4e-3), "implicit_euler");
  EXPECT_GE(decay.decrement, 1.3 * expected_decrement(0.005, decay.frequency));
}

ClothScene strip(const std::string& damping) {
  ClothScene scene;
  scene.grid = {0.2, 0.05, 9, 3};
  scene.material = {{"stretch_warp", "500"},
                    {"stretch_weft", "500"},
                    {"shear", "100"},
                    {"bending", "1e-2"},
                    {"damping", damping}};
  scene.solver = "newton";
  scene.solver_parameters = kConverged;
  scene.time_step = 4e-3;
  return scene;
}

Decay swing(const ClothScene& scene, const BodyGeometry& geometry, const std::string& integration) {
  auto world = make_world(scene, geometry);
  Particles& p = particles_of(*world);
  int tip = 0;
  const double left = p.x.row(0).minCoeff();
  for (int i = 0; i < p.size(); ++i) {
    const double along = p.x(0, i) - left;
    // The end is clamped by two columns.
    if (along < 0.03) p.fix(i);
    if (p.x(0, i) > p.x(0, tip)) tip = i;
    p.v.col(i) << 0.0, 0.0, along < 0.03 ? 0.0 : 0.2 * along * along;
  }
  world->system_changed();
  integrate_by(*world, integration);
  return decay_of(*world, tip);
}

TEST_P(DampedSecondOrder, ABentStripDecaysAsTheMaterialSays) {
  const ClothScene scene = strip("0.01");
  BodyGeometry grid{make_grid(scene.grid), scene.grid};
  BodyGeometry mesh{make_grid(scene.grid), {}};
  for (const BodyGeometry& geometry : {grid, mesh}) {
    const Decay decay = swing(scene, geometry, GetParam());
    EXPECT_NEAR(decay.decrement / expected_decrement(0.01, decay.frequency), 1.0, 0.05);
  }
}

class DampedByAnyIntegration : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, DampedByAnyIntegration,
                         testing::Values("implicit_euler", "bdf2", "midpoint"), test_name_of);

TEST_P(DampedByAnyIntegration, AFreeSpinKeepsItsMomentumAndIsNotDamped) {
  PatchScene scene = bar("0.05", 5e-3);
  scene.material["fiber_stiffness"] = "2e4";
  auto world = make_world(scene);
  integrate_by(*world, GetParam());
  Particles& p = particles_of(*world);
  for (int i = 0; i < p.size(); ++i) {
    p.v.col(i) = 8.0 * Eigen::Vector3d::UnitZ().cross(Eigen::Vector3d(p.x.col(i))) +
                 Eigen::Vector3d(0.1, 0.0, 0.3);
  }
  const Eigen::Vector3d momentum = p.momentum(), angular = p.angular_momentum();
  const double energy = world->energies().total();
  const auto about_center = [&] {
    return Eigen::Vector3d(p.angular_momentum() - p.center_of_mass().cross(p.momentum()));
  };
  const double spin = about_center().z();
  while (world->time() < 1.0 - 1e-9) ASSERT_TRUE(world->step());
  EXPECT_LE((p.momentum() - momentum).norm(), 1e-9 * momentum.norm());
  if (GetParam() == "implicit_euler") return;  // loses of itself, with damping and without
  EXPECT_NEAR(about_center().z() / spin, 1.0, 1e-6);
  EXPECT_LE((p.angular_momentum() - angular).norm(), 1e-6 * angular.norm());
  EXPECT_GE(world->energies().total(), 0.98 * energy) << "a rotation is no strain";
}

TEST_P(DampedByAnyIntegration, DampingOnlyTakesEnergy) {
  const auto energy_after = [&](const std::string& damping) {
    auto world = make_world(bar(damping, 5e-3));
    integrate_by(*world, GetParam());
    Particles& p = particles_of(*world);
    // Bends to and fro, with neither momentum nor angular momentum.
    for (int i = 0; i < p.size(); ++i) p.v.col(i) << 0.0, 0.0, 10.0 * p.x(0, i) * p.x(0, i);
    const Eigen::Vector3d mean = p.momentum() / p.mass.sum();
    p.v.colwise() -= mean;
    const double start = world->energies().total();
    double most = start;
    while (world->time() < 0.1 - 1e-9) {
      EXPECT_TRUE(world->step());
      most = std::max(most, world->energies().total());
    }
    EXPECT_LE(most, 1.01 * start);
    return world->energies().total() / start;
  };
  EXPECT_LE(energy_after("0.005"), 0.7 * energy_after("0"));
}

class DampedByEverySolver : public EverySolver {};
PLIANT_FOR_IMPLICIT_SOLVERS(DampedByEverySolver);

TEST_P(DampedByEverySolver, TakesTheSameDampedSteps) {
  for (const std::string integration : {"implicit_euler", "bdf2", "midpoint"}) {
    const auto run = [&](const std::string& name) {
      ClothScene scene;
      scene.grid = {0.3, 0.3, 5, 5};
      scene.material = soft_material();
      scene.material["bending"] = "1e-4";
      scene.material["damping"] = "1e-3";
      scene.fixed = row_of(scene.grid, 4);
      scene.effects = {{"gravity", {}}};
      scene.solver = name;
      scene.solver_parameters = converged(name);
      scene.time_step = 1e-3;
      auto world = make_world(scene);
      Particles& p = particles_of(*world);
      const Positions start = p.x;
      integrate_by(*world, integration);
      while (world->time() < 0.01 - 1e-9) EXPECT_TRUE(world->step());
      return Positions(p.x - start);
    };
    const Positions expected = run("newton"), found = run(solver());
    const double bound = solver() == "xpbd" ? 1e-4 : 1e-7;
    EXPECT_LE((found - expected).norm(), bound * expected.norm()) << integration;
  }
}

TEST(DampedVerlet, RefusesMaterialsThatDamp) {
  ClothScene scene = strip("0.01");
  scene.solver = "verlet";
  scene.solver_parameters = {};
  try {
    make_world(scene);
    FAIL() << "it should be refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'verlet' is explicit"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("lbfgs"), std::string::npos) << "the cure";
  }
  scene.material["damping"] = "0";
  EXPECT_TRUE(make_world(scene)->step());
}

/// Of the centre of a ball that falls by 10 cm: speed after the bounce over that before.
double restitution(const std::string& damping, const std::string& integration, double dt) {
  PatchScene scene;
  scene.size = {{"radius", "0.05"}};
  scene.options = {{"tetrahedra", "200"}};
  scene.material = {{"young", "3e4"}, {"poisson", "0.3"}, {"density", "500"}, {"damping", damping}};
  scene.pose = at(0, 0, 0.151);
  scene.obstacles = {obstacle(Plane())};
  scene.effects = {{"gravity", {}}, {"contact", {{"thickness", "1e-4"}}}};
  scene.solver = "newton";
  scene.solver_parameters = {{"iterations", "20"}, {"tolerance", "1e-8"}};
  scene.time_step = dt;
  auto world = make_world(scene);
  integrate_by(*world, integration);
  const Particles& p = particles_of(*world);
  double down = 0.0, up = 0.0;
  while (world->time() < 0.35 - 1e-9) {
    EXPECT_TRUE(world->step());
    const double v = p.momentum().z() / p.mass.sum();
    down = std::max(down, -v);
    up = std::max(up, v);
  }
  return up / down;
}

class DampedRestitution : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Dampings, DampedRestitution, testing::Values("0.005", "0.01", "0.015"),
                         [](const auto& info) { return "At" + info.param.substr(2) + "Milli"; });

TEST_P(DampedRestitution, IsTheMaterialsAtAnyStep) {
  const double fine = restitution(GetParam(), "bdf2", 1e-3);
  EXPECT_NEAR(restitution(GetParam(), "bdf2", 10e-3), fine, 0.05);
  EXPECT_NEAR(restitution(GetParam(), "bdf2", 5e-3), fine, 0.05);
  // It takes the steps in contact as bdf2 does.
  EXPECT_NEAR(restitution(GetParam(), "midpoint", 10e-3), fine, 0.05);
  EXPECT_GE(fine, 0.15) << "it bounces";
  // The twin: much of what implicit Euler loses is the step's.
  EXPECT_LE(restitution(GetParam(), "implicit_euler", 10e-3), 0.6 * fine);
}

}  // namespace
}  // namespace pliant::material_damping_test
