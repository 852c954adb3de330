#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <optional>

#include "support/worlds/particle_bodies.h"

namespace pliant::liquid_test {
namespace {

constexpr double kGravity = 9.81;
constexpr double kSpacing = 0.01;

/// Of a column under gravity whose density at rest grows by `share` to the bottom.
ViscoelasticModel::Material column_material(const Eigen::Vector3i& counts, double share) {
  ViscoelasticModel::Material material = liquid_material();
  material.liquid.sound_speed = std::sqrt(kGravity * kSpacing * counts[2] / share);
  material.liquid.viscosity = 0.5;
  return material;
}

void start_in_basin(ParticleWorld& world, const Eigen::Vector3i& counts) {
  add_basin(world, kSpacing * counts.cast<double>());
  world.add_effect("gravity");
  world.add_effect("contact", {{"thickness", "0.002"}});
  world.start();
}

TEST(Liquid, AColumnAtRestHasHydrostaticPressure) {
  const Eigen::Vector3i counts(8, 8, 16);
  const double height = kSpacing * counts[2];
  const ViscoelasticModel::Material material = column_material(counts, 0.005);
  ParticleWorld t(lattice_body(counts, kSpacing), material, 0.01);
  start_in_basin(t, counts);
  ASSERT_EQ(t.run_until(1.5), "");
  const Liquid& liquid = t.model().system().liquid;
  const double surface = t.particles().x.row(2).maxCoeff() + 0.5 * kSpacing;
  EXPECT_NEAR(surface, height, 0.03 * height);
  const double c2 = material.liquid.sound_speed * material.liquid.sound_speed;
  double worst_density = 0.0;
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (int i = 0; i < t.particles().size(); ++i) {
    const double depth = surface - t.particles().x(2, i);
    if (depth < liquid.support()) continue;
    const double error = liquid.last_filling()[i] - 1.0;
    worst_density = std::max(worst_density, std::abs(error));
    const Eigen::Vector2d row(depth, 1.0);
    normal += row * row.transpose();
    right += row * (c2 * 1000.0 * error);
  }
  EXPECT_LT(worst_density, 0.01);
  // The line through the pressures of single particles, which scatter by what their places differ.
  const Eigen::Vector2d line = normal.ldlt().solve(right);
  EXPECT_NEAR(line[0], 1000.0 * kGravity, 0.05 * 1000.0 * kGravity);
  const double weight = kGravity * t.particles().mass.sum();
  double carried = 0.0;
  const int steps = 20;
  for (int k = 0; k < steps; ++k) {
    ASSERT_TRUE(t.world().step());
    carried -= t.world().reactions()[0].force.z() / steps;
  }

  EXPECT_NEAR(carried, weight, 0.01 * weight) << "on the floor; walls carry what drags on them";
}

/// Steps in which a column is said to be compressed whose density grows by `share` to the bottom.
int steps_said_to_be_compressed(double share) {
  const Eigen::Vector3i counts(4, 4, 12);
  ParticleWorld t(lattice_body(counts, kSpacing), column_material(counts, share), 0.01);
  start_in_basin(t, counts);
  int said = 0;
  for (int k = 0; k < 40; ++k) {
    EXPECT_TRUE(t.world().step());
    for (const std::string& warning : body_of(t.world()).report.warnings) {
      said += warning.rfind("liquid_compressed", 0) == 0 ? 1 : 0;
    }
  }
  return said;
}

TEST(Liquid, SaysThatItIsCompressedWhereItsSoundIsTooSlow) {
  EXPECT_GT(steps_said_to_be_compressed(1.0), 10);
  EXPECT_EQ(steps_said_to_be_compressed(0.1), 0);
}

TEST(Liquid, ShearFlowBetweenWallsHasItsProfile) {
  // Plane Poiseuille flow along x between walls at z = 0 and L, driven by a body force g:
  //   v = g/(2 ν) z (L − z),
  // from rest reached to exp(−π² ν t/L²), 0.7 % at half of L²/ν.
  const Eigen::Vector3i counts(30, 14, 10);
  const double acceleration = 0.8, nu = 0.02, height = kSpacing * counts[2];
  ViscoelasticModel::Material material = liquid_material();
  material.liquid.sound_speed = 2.0;
  material.liquid.viscosity = 1000.0 * nu;
  ParticleWorld t(lattice_body(counts, kSpacing), material, 0.005);
  for (double z : {-0.5, height + 0.5}) t.add_box({20.0, 20.0, 1.0}, {0.0, 0.0, z});
  t.add_effect("gravity", {{"acceleration", "[0.8, 0, 0]"}});
  t.add_effect("contact", {{"thickness", "0.002"}});
  t.start();
  ASSERT_EQ(t.run_until(0.5 * height * height / nu), "");
  // In the middle of the free block, where its ends are not felt yet.
  const Eigen::Vector3d middle = t.particles().center_of_mass();
  double above = 0.0, below = 0.0, error = 0.0, scale = 0.0;
  const auto profile = [&](double z) { return acceleration / (2.0 * nu) * z * (height - z); };
  for (int i = 0; i < t.particles().size(); ++i) {
    const Eigen::Vector3d from = t.particles().x.col(i) - middle;
    if (from.head<2>().cwiseAbs().maxCoeff() > 3.0 * kSpacing) continue;
    const double exact = profile(t.particles().x(2, i)), v = t.particles().v(0, i);
    above += v * exact;
    below += exact * exact;
    error += (v - exact) * (v - exact);
    scale += exact * exact;
  }
  EXPECT_NEAR(above / below, 1.0, 0.05);
  EXPECT_LT(std::sqrt(error / scale), 0.05);
}

TEST(Liquid, TheFrontOfABreakingDamRunsAsMeasured) {
  // A column twice as high as wide. Martin and Moyce (1952) found a front that, once it runs, gains
  // 1.33 widths a in the time √(a/2g): 0.67 of the speed 2 √(g 2a) of the shallow-water theory.
  const Eigen::Vector3i counts(10, 8, 20);
  ViscoelasticModel::Material material = liquid_material();
  const double a = kSpacing * counts[0], width = kSpacing * counts[1];
  material.liquid.sound_speed = 15.0;
  material.liquid.viscosity = 0.01;
  ParticleWorld t(lattice_body(counts, kSpacing), material, 0.005);
  t.add_box({4.0, 1.0, 0.1}, {1.0, 0.0, -0.05});
  t.add_box({0.1, 1.0, 2.0}, {-0.05, 0.0, 0.5});
  for (double y : {-0.05, width + 0.05}) t.add_box({4.0, 0.1, 2.0}, {1.0, y, 0.5});
  t.add_effect("gravity");
  t.add_effect("contact", {{"thickness", "0.002"}});
  t.start();
  const auto run_to = [&](double front) {
    while (t.particles().x.row(0).maxCoeff() + 0.5 * kSpacing < front * a &&
           t.world().time() < 2.0) {
      EXPECT_TRUE(t.world().step());
    }
    return t.world().time() / std::sqrt(a / (2.0 * kGravity));
  };
  const double first = run_to(2.0), last = run_to(4.0);

  EXPECT_NEAR(2.0 / (last - first), 1.33, 0.15);
}

/// Moves the first obstacle along x at a constant velocity.
class Pusher final : public ObstacleDriver {
 public:
  explicit Pusher(double velocity) : velocity_(velocity) {}
  void drive(double time, std::vector<Obstacle>& obstacles) override {
    if (!from_) from_ = obstacles[0].pose_end.translation();
    obstacles[0].pose_end.translation() = *from_ + Eigen::Vector3d(velocity_ * time, 0.0, 0.0);
  }

 private:
  double velocity_;
  std::optional<Eigen::Vector3d> from_;
};

TEST(Liquid, AMovingLinkPushesItAndIsPushed) {
  // Without gravity: all the momentum that a block of liquid gains it has from the link.
  ViscoelasticModel::Material material = liquid_material();
  material.liquid.viscosity = 1.0;
  ParticleWorld t(lattice_body({8, 8, 8}, kSpacing), material, 0.005);
  t.add_box({0.1, 0.3, 0.3}, {-0.055, 0.04, 0.04});
  t.world().add_driver(std::make_unique<Pusher>(0.4));
  t.add_effect("contact", {{"thickness", "0.002"}});
  t.start();
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  while (t.world().time() < 0.25) {
    ASSERT_TRUE(t.world().step()) << t.world().failure();
    impulse += t.world().time_step() * t.world().reactions()[0].force;
  }
  const Eigen::Vector3d gained = t.particles().momentum();
  EXPECT_GT(gained.x(), 0.3 * 0.4 * t.particles().mass.sum()) << "it is pushed along";
  EXPECT_LT((gained + impulse).norm(), 1e-9 * gained.norm());
  const double wall = t.world().obstacles()[0].pose_end.translation().x() + 0.05;
  EXPECT_GT(t.particles().x.row(0).minCoeff(), wall) << "nothing is left within";
}

TEST(Liquid, LongStepsAreTakenInAsManySubstepsAsAreStable) {
  // By the sound's and by the viscous limit; beyond max_substeps they are refused
  // (ViscoelasticModel's tests).
  for (const auto& [sound, viscosity] : {std::pair(20.0, 0.1), std::pair(1.0, 200.0)}) {
    ViscoelasticModel::Material material = liquid_material();
    material.liquid.sound_speed = sound;
    material.liquid.viscosity = viscosity;
    ParticleWorld t(lattice_body({6, 6, 6}, kSpacing), material, 0.02);
    t.start();
    const double support = 2.0 * kSpacing;
    const double courant = 0.4 * support / sound;
    const double viscous = 0.07 * support * support / (viscosity / 1000.0);
    ASSERT_TRUE(t.world().step()) << t.world().failure();
    EXPECT_GE(t.body().substeps * std::min(courant, viscous), 0.02);
    EXPECT_LE(t.body().substeps * std::min(courant, viscous), 0.02 * 1.5)
        << "and no more than that";
  }
}

/// Largest change of energy of a shaken liquid without viscosity in a closed box, over all it has.
double energy_error(double dt) {
  ViscoelasticModel::Material material = liquid_material();
  material.liquid.sound_speed = 10.0;
  material.liquid.viscosity = 0.0;
  const Eigen::Vector3i counts(7, 7, 7);
  ParticleWorld t(lattice_body(counts, kSpacing), material, dt);
  const Eigen::Vector3d size = kSpacing * counts.cast<double>();
  add_basin(t, size);
  t.add_box({1.0, 1.0, 0.1}, {0.0, 0.0, size.z() + 0.05});
  t.add_effect("contact", {{"thickness", "1e-6"}, {"margin", "0"}});
  t.start();
  unsigned state = 3;
  for (Eigen::Index k = 0; k < t.particles().v.size(); ++k) {
    state = 1664525u * state + 1013904223u;
    t.particles().v.data()[k] = static_cast<double>(state) / 4294967296.0 - 0.5;
  }
  double first = 0.0, worst = 0.0;
  while (t.world().time() < 0.05) {
    const Eigen::Matrix3Xd before = t.particles().v;
    EXPECT_TRUE(t.world().step()) << t.world().failure();
    EXPECT_EQ(t.body().substeps, 1);
    // Σ V c² ρ⁰ (ln ψ + 1/ψ − 1) of what is compressed, at the start of the step; velocities
    // half a step before and after it.
    double energy = 0.0;
    const Liquid& liquid = t.model().system().liquid;
    for (int i = 0; i < t.particles().size(); ++i) {
      const double psi = std::max(1.0, liquid.last_filling()[i]);
      energy += liquid.volumes()[i] * 1000.0 * 100.0 * (std::log(psi) + 1.0 / psi - 1.0);
      const Eigen::Vector3d v = 0.5 * (before.col(i) + t.particles().v.col(i));
      energy += 0.5 * t.particles().mass[i] * v.squaredNorm();
    }
    if (first == 0.0) first = energy;
    worst = std::max(worst, std::abs(energy - first) / first);
  }
  return worst;
}

TEST(Liquid, EnergyIsKeptToTheOrderOfTheIntegrator) {
  const double coarse = energy_error(4e-4), fine = energy_error(2e-4);
  EXPECT_LT(coarse, 0.05);
  EXPECT_LT(fine, 0.6 * coarse);
}

TEST(Liquid, TwoBodiesKeepMomentumExactly) {
  ViscoelasticModel::Material liquid = liquid_material(), solid;
  solid.liquid.density = 3000.0;
  const BodyGeometry drop = sampled_box({0.06, 0.06, 0.06}, kSpacing);
  const BodyGeometry block = sampled_box({0.04, 0.05, 0.06}, kSpacing);
  ParticleWorld t(drop, liquid, 0.005);
  t.add(block, solid, {0.06, 0.01, 0.0}, {-1.0, 0.2, 0.0});
  t.start("gauss_seidel", {{"iterations", "20"}});
  const Eigen::Vector3d before = t.particles().momentum();
  ASSERT_EQ(t.run_until(0.2), "");
  const Eigen::Vector3d change = t.particles().momentum() - before;

  EXPECT_LT(change.norm(), 1e-10 * before.norm());
  double pushed = 0.0;
  for (int i = 0; i < drop.interior_points.cols(); ++i) pushed += t.particles().v(0, i);
  EXPECT_LT(pushed, 0.0) << "they met";
}

}  // namespace
}  // namespace pliant::liquid_test
