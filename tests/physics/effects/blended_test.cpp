#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/effects/attachment.h"
#include "support/solvers/solvers.h"
#include "support/worlds/particle_bodies.h"

namespace pliant::blended_test {
namespace {

ViscoelasticModel::Material elastic(double young) {
  ViscoelasticModel::Material material;
  material.solid.young = young;
  return material;
}

/// Elongation of a bar of the length 0.2 that is held at one end and pulled with a uniform body
/// force, over that of Young's modulus.
double elongation_ratio(double spacing, const std::string& solver, double dt) {
  const double length = 0.2, thick = 0.06, young = 2e4, pull = 5.0;
  const Eigen::Vector3i counts(static_cast<int>(std::lround(length / spacing)),
                               static_cast<int>(std::lround(thick / spacing)),
                               static_cast<int>(std::lround(thick / spacing)));
  ParticleWorld t(lattice_body(counts, spacing), elastic(young), dt);
  const double held = 0.04;
  for (int i = 0; i < t.particles().size(); ++i) {
    if (t.particles().x(0, i) < held) t.particles().fix(i);
  }
  t.add_effect("gravity", {{"acceleration", "[5, 0, 0]"}});
  t.add_effect("damping", {{"rate", "30"}});
  t.start(solver, {{"iterations", "200"}, {"tolerance", "1e-6"}});
  const Positions rest = t.particles().x;
  EXPECT_EQ(t.run_until(1.5), "");
  // u(x) = ρ g/E (L x − x²/2) from the held end on, for each particle.
  double above = 0.0, below = 0.0;
  const double free_length = length - held;
  for (int i = 0; i < t.particles().size(); ++i) {
    const double x = rest(0, i) - held;
    if (x < 0.0) continue;
    const double exact = 1000.0 * pull / young * (free_length * x - 0.5 * x * x);
    above += exact * (t.particles().x(0, i) - rest(0, i));
    below += exact * exact;
  }
  return above / below;
}

TEST(Blended, StiffnessOfABarApproachesTheModulus) {
  const double coarse = elongation_ratio(0.02, "direct", 0.01);
  const double fine = elongation_ratio(0.01, "direct", 0.01);
  const double other = elongation_ratio(0.02, "chebyshev", 0.02);
  EXPECT_NEAR(fine, 1.0, 0.1);
  EXPECT_LT(std::abs(fine - 1.0), std::abs(coarse - 1.0));
  EXPECT_NEAR(other, coarse, 0.01 * coarse) << "neither solver nor time step matter";
}

TEST(Blended, BodiesOfAnySizeAndMassBehaveTheSame) {
  // Young's modulus, velocities and time scaled such that every term of the motion has the same
  // weight: x' = s x, t' = √s t, E' = E ρ s. Lengths and masses of the whole body.
  const Eigen::Vector3i counts(6, 5, 4);
  Positions reference;
  for (const auto& [length, mass] :
       {std::pair(0.06, 0.12), std::pair(1e-3, 1e-3), std::pair(1e-3, 1e3), std::pair(1e3, 1e-3),
        std::pair(1e3, 1e3), std::pair(0.06, 1e-3), std::pair(0.06, 1e3)}) {
    const double scale = length / 0.06;
    const double density = mass / (120.0 * std::pow(0.01 * scale, 3.0));
    ViscoelasticModel::Material material = elastic(1e4 * scale * density / 1000.0);
    material.liquid.density = density;
    material.liquid.sound_speed = 5.0 * std::sqrt(scale);
    material.liquid.viscosity = 0.5 * std::pow(scale, 1.5) * density / 1000.0;
    material.beta = 0.5;
    ParticleWorld t(lattice_body(counts, 0.01 * scale), material, 0.01 * std::sqrt(scale));
    t.world().finite_check().max_distance = 1e9;
    for (int i = 0; i < 20; ++i) t.particles().fix(i);
    t.add_effect("gravity", {{"acceleration", "[3, 0, -9.81]"}});
    t.start("jacobi", {{"iterations", "30"}});
    for (int k = 0; k < 20; ++k) ASSERT_TRUE(t.world().step()) << t.world().failure();
    const Positions x = t.particles().x / scale;
    if (reference.size() == 0) reference = x;
    EXPECT_LT((x - reference).cwiseAbs().maxCoeff(), 1e-6) << length << " m, " << mass << " kg";
  }
}

TEST(Blended, SameBitsForAnyNumberOfThreadsAndAfterLoading) {
  Positions first;
  for (int count : {1, 3}) {
    set_threads(count);
    ViscoelasticModel::Material material = elastic(5e3);
    material.beta = 0.4;
    ParticleWorld t(sampled_box({0.1, 0.08, 0.06}, 0.01), material, 0.005);
    ViscoelasticModel::Material block;
    block.solid.rigid = true;
    block.solid.alpha = 0.99;
    t.add_box({1.0, 1.0, 0.1}, {0.0, 0.0, -0.1});
    t.add(sampled_box({0.03, 0.03, 0.03}, 0.01), block, {0.0, 0.0, 0.07});
    t.add_effect("gravity");
    t.add_effect("contact", {{"thickness", "0.002"}});
    t.add_effect("heat", {{"initial_temperature", "304"}, {"convection", "1e5"}});
    t.start("chebyshev", {{"iterations", "15"}});
    ASSERT_EQ(t.run_until(0.05), "");
    const Checkpoint checkpoint = t.world().save();
    ASSERT_EQ(t.run_until(0.15), "");
    const Positions x = t.particles().x;
    if (first.size() == 0) first = x;
    EXPECT_TRUE(x == first) << count << " threads";
    t.world().load(checkpoint);
    ASSERT_EQ(t.run_until(0.15), "");
    EXPECT_TRUE(t.particles().x == first) << "loaded, " << count << " threads";
    t.world().reset();
    ASSERT_EQ(t.run_until(0.15), "");
    EXPECT_TRUE(t.particles().x == first) << "reset, " << count << " threads";
  }
  set_threads(1);
}

/// Largest error of a distance between particles, in spacings, 3 s after all were thrown out of
/// place by up to 0.15 spacings.
double error_at_rest(const Eigen::Vector3i& counts, const ViscoelasticModel::Material& material) {
  const double spacing = 0.01;
  ParticleWorld t(lattice_body(counts, spacing), material, 0.01);
  t.add_effect("damping", {{"rate", "20"}});
  t.start("gauss_seidel", {{"iterations", "30"}});
  const Positions rest = t.particles().x;
  unsigned state = 7;
  for (Eigen::Index k = 0; k < rest.size(); ++k) {
    state = 1664525u * state + 1013904223u;
    t.particles().x.data()[k] += 0.3 * spacing * (static_cast<double>(state) / 4294967296.0 - 0.5);
  }
  EXPECT_EQ(t.run_until(3.0), "");
  double worst = 0.0;
  for (int i = 0; i < t.particles().size(); ++i) {
    for (int j = 0; j < i; ++j) {
      worst = std::max(worst, std::abs((t.particles().x.col(i) - t.particles().x.col(j)).norm() -
                                       (rest.col(i) - rest.col(j)).norm()));
    }
  }
  return worst / spacing;
}

TEST(Blended, AnyArrangementComesToRestInItsShape) {
  // A point, a line, a plane and a box, with particles that turn, however turns are blended.
  for (const Eigen::Vector3i& counts : {Eigen::Vector3i(1, 1, 1), Eigen::Vector3i(8, 1, 1),
                                        Eigen::Vector3i(6, 5, 1), Eigen::Vector3i(4, 4, 4)}) {
    ViscoelasticModel::Material material = elastic(1e4);
    material.oriented = true;
    for (const TurnBlend blend :
         {TurnBlend::kMoments, TurnBlend::kLinear, TurnBlend::kExponential}) {
      material.turn_blend = blend;
      EXPECT_LT(error_at_rest(counts, material), 1e-3) << counts.transpose();
    }
  }
}

TEST(Blended, ShapeMatchingOfPointsLinesAndPlanesIsHarmless) {
  // Their clusters leave a rotation free, which no force depends on: not refused, since they come
  // to rest in their shape as well.
  for (const Eigen::Vector3i& counts :
       {Eigen::Vector3i(1, 1, 1), Eigen::Vector3i(8, 1, 1), Eigen::Vector3i(6, 5, 1)}) {
    EXPECT_LT(error_at_rest(counts, elastic(1e4)), 1e-3) << counts.transpose();
  }
}

TEST(Blended, WhatIsHeldHangsByItsWeight) {
  ParticleWorld t(lattice_body({5, 5, 5}, 0.01), elastic(2e4), 0.005);
  t.add_box({0.1, 0.1, 0.01}, {0.025, 0.025, 0.1});
  t.add_effect("gravity");
  t.add_effect("damping", {{"rate", "20"}});
  t.start("chebyshev", {{"iterations", "60"}});
  AttachmentRequest request;
  request.name = "grip";
  request.region.kind = Region::Kind::kBox;
  request.region.box = {Eigen::Vector3d(0, 0, 0.04), Eigen::Vector3d(0.05, 0.05, 0.05)};
  request.count = t.particles().size();
  request.obstacle = 0;
  request.stiffness = 500.0;
  EXPECT_EQ(attachments_of(t.body(), t.world().obstacles()).attach_now(request, 0.005), 25);
  ASSERT_EQ(t.run_until(1.5), "");
  const double weight = 9.81 * t.particles().mass.sum();
  EXPECT_NEAR(-t.world().reactions()[0].force.z() / weight, 1.0, 0.01);
  EXPECT_LT(t.particles().v.cwiseAbs().maxCoeff(), 1e-3) << "it hangs still";
  attachments_of(t.body(), t.world().obstacles()).detach("grip", 0.005);
  ASSERT_EQ(t.run_until(1.6), "");
  // dv/dt = −g − 20 v: a step of 5 ms makes that 5 % wrong at most.
  const double falling = 9.81 / 20.0 * (1.0 - std::exp(-20.0 * 0.1));
  EXPECT_NEAR(-t.particles().v.row(2).mean(), falling, 0.05 * falling) << "and falls when let go";
}

TEST(Blended, ShapeMatchingThatBeginsInsideOutIsRefused) {
  for (const Eigen::Vector3d& scale : {Eigen::Vector3d(1, 1, -1), Eigen::Vector3d(-1, -1, -1)}) {
    ParticleWorld t(lattice_body({4, 4, 4}, 0.01), elastic(1e4), 0.01);
    t.start("jacobi", {{"iterations", "20"}});
    const Positions start = scale.asDiagonal() * t.particles().x;
    t.particles().x = start;
    const std::string refusal = t.run_until(0.01);
    EXPECT_NE(refusal.find("inside out"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("oriented: true"), std::string::npos) << refusal;
    EXPECT_EQ(t.particles().x, start);
  }
}

TEST(Blended, MirroredAndCrushedBodiesStayFiniteAndBounded) {
  for (const std::string solver : {"jacobi", "chebyshev", "gauss_seidel", "xpbd"}) {
    for (const Eigen::Vector3d& scale :
         {Eigen::Vector3d(1, 1, -1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0)}) {
      ViscoelasticModel::Material material = elastic(1e4);
      material.beta = 0.3;
      ParticleWorld t(lattice_body({4, 4, 4}, 0.01), material, 0.01);
      t.start(solver, {{"iterations", "20"}});
      ASSERT_EQ(t.run_until(0.01), "");  // what begins inside out is refused
      t.particles().x = scale.asDiagonal() * t.particles().x;
      ASSERT_EQ(t.run_until(0.5), "") << solver;
      EXPECT_LT(t.particles().v.cwiseAbs().maxCoeff(), 20.0) << solver;
    }
  }
}

TEST(Blended, OrientedParticlesReturnToRestFromMirroredAndCrushedStarts) {
  // Mirrored, turned inside out, crushed to a plane, a line and a point: proper rotations never
  // take part in a reflection, and a particle's own turn tells its clusters what is up.
  for (const Eigen::Vector3d& scale :
       {Eigen::Vector3d(1, 1, -1), Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 0),
        Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 0)}) {
    ViscoelasticModel::Material material = elastic(1e4);
    material.oriented = true;
    const double spacing = 0.01;
    ParticleWorld t(lattice_body({4, 3, 3}, spacing), material, 0.01);
    t.add_effect("damping", {{"rate", "10"}});
    t.start("gauss_seidel", {{"iterations", "30"}});
    const Positions rest = t.particles().x;
    t.particles().x = scale.asDiagonal() * rest;
    ASSERT_EQ(t.run_until(4.0), "") << scale.transpose();
    double worst = 0.0;
    for (int i = 0; i < t.particles().size(); ++i) {
      for (int j = 0; j < i; ++j) {
        worst = std::max(worst, std::abs((t.particles().x.col(i) - t.particles().x.col(j)).norm() -
                                         (rest.col(i) - rest.col(j)).norm()));
      }
    }
    EXPECT_LT(worst / spacing, 1e-3) << scale.transpose();
    // Distances alone would be met by a mirror image.
    const Eigen::Matrix3d moment = (t.particles().x.colwise() - t.particles().x.rowwise().mean()) *
                                   (rest.colwise() - rest.rowwise().mean()).transpose();
    EXPECT_GT(moment.determinant(), 0.0) << scale.transpose();
  }
}

/// Oriented bodies in one scene, each placed at another turn as scenes place them: two of many
/// particles and one of a single one.
void add_turned_bodies(ParticleWorld& t, const ViscoelasticModel::Material& material) {
  const auto place = [](const Eigen::Vector3d& at, double angle, const Eigen::Vector3d& axis) {
    return Eigen::Translation3d(at) * Eigen::AngleAxisd(angle, axis.normalized());
  };
  auto first = std::make_unique<ViscoelasticModel>(lattice_body({5, 3, 2}, 0.01), material);
  first->place(Eigen::Isometry3d(place({0, 0, 0}, 2.1, {1, -2, 3})));
  t.world().add_body("first", std::move(first));
  auto second = std::make_unique<ViscoelasticModel>(lattice_body({3, 3, 3}, 0.01), material);
  second->place(Eigen::Isometry3d(place({0.2, 0.1, 0}, -1.3, {0, 1, 1})));
  ASSERT_TRUE(t.body().model->join(*second));
  auto single = std::make_unique<ViscoelasticModel>(lattice_body({1, 1, 1}, 0.01), material);
  single->place(Eigen::Isometry3d(place({-0.2, 0.1, 0.1}, 3.0, {1, 1, 0})));
  ASSERT_TRUE(t.body().model->join(*single));
}

TEST(Blended, OrientedBodiesThatAreTurnedStartAndStayAtRest) {
  const std::vector<std::string> solvers = all_solvers().names_for("viscoelastic");
  ASSERT_GE(solvers.size(), 8u);
  for (const std::string& solver : solvers) {
    for (const double beta : {0.0, 0.5, 1.0}) {
      for (const bool rigid : {false, true}) {
        for (const TurnBlend blend :
             {TurnBlend::kMoments, TurnBlend::kLinear, TurnBlend::kExponential}) {
          ViscoelasticModel::Material material = elastic(1e4);
          material.oriented = true;
          material.turn_blend = blend;
          material.beta = beta;
          material.solid.rigid = rigid;
          if (rigid) material.solid.alpha = 0.99;
          ParticleWorld t(1e-3);
          add_turned_bodies(t, material);
          t.start(solver, {});
          const std::string what =
              fmt::format("{}, beta {}, {}, blend {}", solver, beta, rigid ? "rigid" : "elastic",
                          static_cast<int>(blend));
          EXPECT_LT(t.world().energies().elastic, 1e-20) << what;
          // Far above the largest step of what alpha = 0.99 stands for, which it warns of.
          if (is_explicit(solver) && rigid) continue;
          const Positions start = t.particles().x;
          ASSERT_EQ(t.run_until(0.01), "") << what;
          // A liquid's pressure moves what was sampled unevenly; no force of shape matching does.
          if (beta == 0.0) {
            EXPECT_LT((t.particles().x - start).cwiseAbs().maxCoeff(), 1e-12) << what;
            EXPECT_LT(t.world().energies().kinetic, 1e-18) << what;
          }
          EXPECT_LT(t.world().energies().elastic + t.world().energies().kinetic, 1e-4) << what;
        }
      }
    }
  }
}

TEST(Blended, OrientedBodiesFallWhateverTheirTurnAndStep) {
  // A rigid body and a single particle, by few iterations at a very short step,
  // where the stiffness that alpha stands for is the largest.
  for (const Eigen::Vector3i& counts : {Eigen::Vector3i(5, 4, 3), Eigen::Vector3i(1, 1, 1)}) {
    ViscoelasticModel::Material material;
    material.oriented = true;
    material.solid.rigid = true;
    material.solid.alpha = 0.99;
    ParticleWorld t(2e-5);
    auto model = std::make_unique<ViscoelasticModel>(lattice_body(counts, 0.1), material);
    model->place(
        Eigen::Isometry3d(Eigen::AngleAxisd(-1.9, Eigen::Vector3d(1, 2, -1).normalized())));
    t.world().add_body("body", std::move(model));
    t.add_effect("gravity");
    t.start("jacobi", {{"iterations", "10"}});
    const Positions start = t.particles().x;
    ASSERT_EQ(t.run_until(20 * 2e-5), "");
    const double fallen = -9.81 * 2e-5 * 2e-5 * 210.0;  // g h² (1 + 2 + ... + 20)
    Positions moved = t.particles().x - start;
    moved.row(2).array() -= fallen;
    EXPECT_LT(moved.cwiseAbs().maxCoeff(), 1e-12) << counts.transpose();
  }
}

TEST(Blended, AStepOfMoreSubstepsThanCanBeCountedIsRefused) {
  // So light that viscosity alone asks for 1e11 substeps.
  ViscoelasticModel::Material material;
  material.beta = 1.0;
  material.liquid.density = 1e-6;
  ParticleWorld t(lattice_body({2, 2, 2}, 1e-3), material, 0.03);
  t.start("jacobi");
  const std::string refusal = t.run_until(0.03);
  EXPECT_NE(refusal.find("max_substeps"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("more than"), std::string::npos) << refusal;
}

TEST(Blended, AResetPutsOrientationsBackToTheScenes) {
  ViscoelasticModel::Material material = elastic(1e4);
  material.oriented = true;
  ParticleWorld t(1e-3);
  add_turned_bodies(t, material);
  t.start("gauss_seidel", {});
  for (int i = 0; i < t.particles().size(); i += 3) t.particles().v(0, i) = 0.5;
  ASSERT_EQ(t.run_until(0.02), "");
  EXPECT_GT(t.world().energies().elastic, 1e-8);
  t.world().reset();
  EXPECT_LT(t.world().energies().elastic, 1e-20);
}

TEST(Blended, ChangingBetaNeitherJerksNorAddsEnergy) {
  ParticleWorld t(sampled_box({0.06, 0.06, 0.06}, 0.01), elastic(1e4), 0.005);
  t.start("direct", {{"iterations", "20"}});
  // Stretched, so that it holds energy.
  t.particles().x.row(0) *= 1.2;
  double energy = t.world().energies().total();
  for (int k = 0; k < 100; ++k) {
    const double beta = 0.5 - 0.5 * std::cos(0.1 * k);
    for (int i = 0; i < t.particles().size(); ++i) t.model().set_beta(i, std::min(0.9, beta));
    const Eigen::Matrix3Xd before = t.particles().v;
    ASSERT_TRUE(t.world().step());
    const double now = t.world().energies().total();
    // Liquid's own energy is not counted: what it holds of the compression it may give back.
    if (beta < 0.05) {
      EXPECT_LE(now, energy * (1.0 + 1e-6) + 1e-12) << k;
    }
    energy = std::max(now, 1e-12);
  }
}

TEST(Blended, BetaSetForARegionNeverRaisesTheElasticEnergy) {
  // A stretched block whose half at x > 0 becomes softer or stiffer, at once or little by little.
  for (const auto& [from, to] : {std::pair(0.0, 0.8), std::pair(0.8, 0.0), std::pair(1.0, 0.0)}) {
    for (const double duration : {0.0, 0.05}) {
      const double young = 1e4, side = 0.06;
      ViscoelasticModel::Material material = elastic(young);
      material.beta = from;
      ParticleWorld t(sampled_box({side, side, side}, 0.01), material, 0.005);
      t.start("direct", {{"iterations", "10"}});
      t.particles().x.row(0) *= 1.2;
      // Of positions as strains.
      const double round_off = young * std::pow(side, 3.0) * std::pow(64.0 * 2.2e-16, 2.0);
      FieldRequest request;
      request.field = "beta";
      request.region.kind = Region::Kind::kBox;
      request.region.box = {Eigen::Vector3d(0, -1, -1), Eigen::Vector3d(1, 1, 1)};
      request.value = to;
      request.duration = duration;
      EXPECT_GT(t.world().set_field(request), 50);
      BlendedClusters& solid = t.model().system().solid();
      for (int k = 0; k < 12; ++k) {
        const Positions x = t.particles().x, v = t.particles().v;
        const double before = solid.energy(x);
        solid.follow(t.model().beta(), x);
        EXPECT_LE(solid.energy(x), before * (1.0 + 1e-12) + round_off)
            << from << " to " << to << ", " << k;
        t.world().system_changed();
        ASSERT_TRUE(t.world().step()) << t.world().failure();
        // Without a jerk: no more than what the stretched solid does from the start.
        const double largest = (t.particles().v - v).cwiseAbs().maxCoeff();
        EXPECT_LT(largest, 1.0) << from << " to " << to << ", " << k;
      }
      EXPECT_EQ(t.model().beta().maxCoeff(), std::max(from, to));
      EXPECT_EQ(t.model().beta().minCoeff(), std::min(from, to));
    }
  }
}

}  // namespace
}  // namespace pliant::blended_test
