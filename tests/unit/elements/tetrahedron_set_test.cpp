// Tetrahedra by themselves: corotated energy, volume, limits of strain.
#include "pliant/elements/solids/tetrahedron_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/elements/solids/principal_stretches.h"
#include "pliant/elements/solids/strain_limit_set.h"
#include "pliant/elements/solids/volume_set.h"
#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/solvers/matrices.h"

namespace pliant {
namespace {

TetrahedralMesh one_tetrahedron() {
  TetrahedralMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 0.1, 0.02, 0.03,  //
      0, 0.01, 0.09, 0.02,              //
      0, 0.0, 0.01, 0.11;
  mesh.tetrahedra.resize(4, 1);
  mesh.tetrahedra << 0, 1, 2, 3;
  return mesh;
}

Positions mapped(const TetrahedralMesh& mesh, const Eigen::Matrix3d& map) {
  return map * mesh.vertices;
}

Eigen::Matrix3d diagonal(double a, double b, double c) {
  return Eigen::Vector3d(a, b, c).asDiagonal();
}

TEST(TetrahedronSet, EnergyOfStretches) {
  const TetrahedralMesh mesh = one_tetrahedron();
  const double volume = volumes(mesh)[0];
  Random random(1);
  const TetrahedronSet set(mesh, 300.0);
  const auto energy = [&](const Eigen::Matrix3d& map) { return set.energy(mapped(mesh, map)); };
  const Eigen::Matrix3d u = random.rotation(), v = random.rotation();
  // s v Σ (σ - 1)², with the sign of the determinant at the smallest stretch.
  EXPECT_NEAR(energy(u * diagonal(1.3, 0.9, 0.6) * v), 300.0 * volume * 0.26, 1e-12);
  EXPECT_NEAR(energy(u * diagonal(-1.3, 0.9, 0.6) * v), 300.0 * volume * 2.66, 1e-12);
  EXPECT_NEAR(energy(u * diagonal(1.3, 0.9, 0.0) * v), 300.0 * volume * 1.1, 1e-12);
  EXPECT_NEAR(energy(u * diagonal(1.3, 0.0, 0.0) * v), 300.0 * volume * 2.09, 1e-12);
  EXPECT_NEAR(energy(Eigen::Matrix3d::Zero()), 300.0 * volume * 3.0, 1e-12);
}

TEST(VolumeSet, EnergyOfStretches) {
  const TetrahedralMesh mesh = one_tetrahedron();
  const double volume = volumes(mesh)[0];
  const VolumeSet set(mesh, 400.0);
  // From 1.2 I the nearest is I; stretches (2, 1/2, 1) keep the volume.
  EXPECT_NEAR(set.energy(1.2 * mesh.vertices), 200.0 * volume * 3.0 * 0.04, 1e-12);
  EXPECT_NEAR(set.energy(mapped(mesh, diagonal(2.0, 0.5, 1.0))), 0.0, 1e-15);
  EXPECT_NEAR(set.energy(0.0 * mesh.vertices), 200.0 * volume * 3.0, 1e-12);
}

TEST(VolumeSet, LimitsLeaveRoom) {
  const TetrahedralMesh mesh = one_tetrahedron();
  const VolumeSet set(mesh, 400.0, {0.8, 1.5});
  for (const double inside : {0.81, 1.0, 1.49}) {
    const Positions x = std::cbrt(inside) * mesh.vertices;
    EXPECT_EQ(set.energy(x), 0.0) << inside;
    EXPECT_TRUE(forces_of(set, x).isZero(0.0));
    EXPECT_TRUE(stiffness_of(set, x).isZero(0.0));
  }
  const double side = std::cbrt(1.5);
  const Positions x = 1.3 * mesh.vertices;
  EXPECT_NEAR(set.energy(x), 200.0 * volumes(mesh)[0] * 3.0 * (1.3 - side) * (1.3 - side), 1e-12);
  EXPECT_GT(set.energy(0.9 * mesh.vertices), 0.0);
}

TEST(StrainLimitSet, FeelsOnlyWhatIsBeyond) {
  const TetrahedralMesh mesh = one_tetrahedron();
  const double volume = volumes(mesh)[0];
  const StrainLimitSet set(mesh, 400.0, {0.8, 1.1});
  Random random(2);
  const Eigen::Matrix3d u = random.rotation(), v = random.rotation();
  const auto energy = [&](const Eigen::Matrix3d& map) { return set.energy(mapped(mesh, map)); };
  EXPECT_EQ(energy(u * diagonal(1.05, 1.0, 0.95) * v), 0.0);
  EXPECT_NEAR(energy(u * diagonal(1.09, 1.0, 0.81) * v), 0.0, 1e-25);
  EXPECT_NEAR(energy(u * diagonal(1.3, 1.0, 0.7) * v), 200.0 * volume * 0.05, 1e-12);
  EXPECT_NEAR(energy(u * diagonal(1.3, 1.0, -0.7) * v), 200.0 * volume * (0.04 + 2.25), 1e-12);
}

TEST(StrainLimitSet, NoUpperLimitIsInfinity) {
  const TetrahedralMesh mesh = one_tetrahedron();
  const StrainLimitSet set(mesh, 400.0, {0.8, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(set.energy(100.0 * mesh.vertices), 0.0);
  EXPECT_GT(set.energy(0.5 * mesh.vertices), 0.0);
}

/// Each kind of tetrahedron by its name.
std::unique_ptr<ElementSet> make(const std::string& kind, const TetrahedralMesh& mesh) {
  if (kind == "tetrahedron") return std::make_unique<TetrahedronSet>(mesh, 500.0);
  if (kind == "volume") return std::make_unique<VolumeSet>(mesh, 1000.0);
  return std::make_unique<StrainLimitSet>(mesh, 1000.0, StretchLimits{0.9, 1.1});
}

class Tetrahedra : public testing::TestWithParam<std::string> {
 protected:
  TetrahedralMesh mesh_ = one_tetrahedron();
  std::unique_ptr<ElementSet> set_ = make(GetParam(), mesh_);
};

INSTANTIATE_TEST_SUITE_P(Sets, Tetrahedra, testing::Values("tetrahedron", "volume", "strain_limit"),
                         [](const auto& info) { return info.param; });

TEST_P(Tetrahedra, InvertedStatesHaveConsistentForces) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    // σ₁ + σ₂ stays away from zero, where the force jumps.
    const Eigen::Matrix3d map = random.rotation() *
                                diagonal(random(1.2, 1.5), random(0.8, 1.0), -random(0.1, 0.4)) *
                                random.rotation();
    const Positions x = mapped(mesh_, map);
    const Forces f = forces_of(*set_, x);
    const double h = 1e-7;
    for (int k = 0; k < 12; ++k) {
      Positions up = x, down = x;
      up.data()[k] += h;
      down.data()[k] -= h;
      const double slope = (set_->energy(up) - set_->energy(down)) / (2.0 * h);
      ASSERT_NEAR(f.data()[k], -slope, 1e-6 * f.norm());
    }
    const Eigen::MatrixXd k = stiffness_of(*set_, x);
    EXPECT_LE((k - stiffness_by_differences(*set_, x, h)).norm(), 1e-5 * k.norm());
  }
}

TEST_P(Tetrahedra, DegenerateStatesAreFiniteAndPulledBack) {
  const double e = 1e-9;
  for (const Eigen::Matrix3d& map :
       {diagonal(0, 0, 0), diagonal(1, 0, 0), diagonal(1, 1, 0), diagonal(1, 1, -1),
        diagonal(-1, -1, -1), diagonal(1, 0.5, -0.5), diagonal(1, e, -e), diagonal(e, e, e),
        diagonal(1e6, 1, -1), diagonal(1e-200, 0, 0)}) {
    Positions x = mapped(mesh_, map);
    EXPECT_TRUE(forces_of(*set_, x).allFinite()) << map;
    EXPECT_TRUE(stiffness_of(*set_, x).allFinite()) << map;
    EXPECT_TRUE(stiffness_of(*set_, x, Definiteness::kProjected).allFinite()) << map;
    // Projective steps, with inertia so small that the rotation is free at once.
    const double start = set_->energy(x);
    for (int step = 0; step < 200; ++step) {
      set_->reset_multipliers();
      set_->relax(Eigen::VectorXd::Constant(4, 1e3), 1.0, x);
    }
    EXPECT_TRUE(x.allFinite()) << map;
    EXPECT_LE(set_->energy(x), 1e-9 * start) << map;
  }
}

TEST_P(Tetrahedra, StiffOnesWithFixedCornersKeepTheirDigits) {
  // Three corners fixed and a huge compliance ratio: what is left for the fourth is one equation.
  Eigen::VectorXd inverse_mass = Eigen::VectorXd::Zero(4);
  inverse_mass[3] = 1e3;
  Positions x = mesh_.vertices;
  x.col(3) *= 2.0;
  const double start = set_->energy(x);
  set_->reset_multipliers();
  for (int sweep = 0; sweep < 100; ++sweep) set_->relax(inverse_mass, 1e4, x);
  EXPECT_TRUE(x.allFinite());
  EXPECT_LE(set_->energy(x), 0.5 * start);
  EXPECT_EQ(x.leftCols(3), mesh_.vertices.leftCols(3));
}

/// d²Ψ/dG² by its eigenmatrices: 2 (I + ρ/2 r rᵀ − 1/2 Σ twistₖ tₖ tₖᵀ), r = R, tₖ = R [vₖ]×.
Matrix9d corotated_tangent(double ratio, const Eigen::Matrix3d& g, Definiteness definiteness) {
  const PrincipalStretches stretches = principal_stretches(g);
  const double p = 1.0 - 0.5 * ratio * (stretches.sigma.sum() - 3.0);
  Eigen::Vector3d twist = twist_slopes(stretches.sigma, Eigen::Vector3d::Constant(p));
  if (definiteness == Definiteness::kProjected) twist = twist.cwiseMin(1.0);
  const Eigen::Matrix3d rotation = stretches.compose(Eigen::Vector3d::Ones());
  const auto flat = [](const Eigen::Matrix3d& m) {
    return Eigen::Matrix<double, 9, 1>(Eigen::Map<const Eigen::Matrix<double, 9, 1>>(m.data()));
  };
  Matrix9d tangent = 2.0 * Matrix9d::Identity();
  tangent += ratio * flat(rotation) * flat(rotation).transpose();
  for (int k = 0; k < 3; ++k) {
    Eigen::Matrix3d turned;
    for (int j = 0; j < 3; ++j) {
      turned.col(j) = stretches.v.col(k).cross(Eigen::Vector3d::Unit(j));
    }
    const Eigen::Matrix<double, 9, 1> direction = flat(rotation * turned);
    tangent -= twist[k] * direction * direction.transpose();
  }
  return tangent;
}

TEST(TetrahedronSet, AnswersAsItsEigenmatricesSay) {
  Random random(17);
  Simplex<3> simplex;
  simplex.shape.rightCols<3>() = random.rotation() + 0.3 * random.rotation();
  simplex.shape.col(0) = -simplex.shape.rightCols<3>().rowwise().sum();
  // At rest, stretched, pressed, and pressed along one axis only, so that some of the twists are
  // too stiff; inverted, nearly without a rotation, and flat.
  const std::vector<Eigen::Vector3d> all = {
      {1, 1, 1},         {1.1, 1.05, 1.2}, {0.9, 0.8, 0.95},
      {1.2, 0.97, 0.7},  {1.4, 1.0, 0.55}, {1.2, 0.9, -0.3},
      {0.5, 0.4, -0.39}, {1.1, 0.9, 0.0},  {1 + 1e-9, 1, 1 - 1e-9}};
  for (const double ratio : {0.0, 1.5, 9.0}) {
    const CorotatedLaw law{ratio};
    for (const Eigen::Vector3d& sigma : all) {
      const Eigen::Matrix3d g =
          random.rotation() * sigma.asDiagonal() * random.rotation().transpose();
      for (const Definiteness definiteness : {Definiteness::kExact, Definiteness::kProjected}) {
        const Matrix9d tangent = corotated_tangent(ratio, g, definiteness);
        VertexBlocks<3> blocks;
        find_vertex_blocks(law, simplex, g, definiteness, blocks);
        auto block = blocks.begin();
        for (int r = 0; r < 4; ++r) {
          for (int c = r; c < 4; ++c, ++block) {
            Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
            for (int i = 0; i < 3; ++i) {
              for (int j = 0; j < 3; ++j) {
                expected +=
                    simplex.shape(i, r) * simplex.shape(j, c) * tangent.block<3, 3>(3 * i, 3 * j);
              }
            }
            // Eigenvectors by closed form have half of the digits at the least.
            EXPECT_LT((*block - expected).norm(), 1e-7 * tangent.norm())
                << "ratio " << ratio << ", stretches " << sigma.transpose();
          }
        }
      }
    }
  }
}

TEST(TetrahedronSet, RefusesBadInput) {
  const TetrahedralMesh mesh = make_block({{1, 1, 1}, {1, 1, 1}});
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal([&] { TetrahedronSet(mesh, bad); }, {"tetrahedron 0", "Pa", "positive"});
    expect_refusal([&] { VolumeSet(mesh, bad); }, {"volume 0", "Pa", "positive"});
    expect_refusal([&] { StrainLimitSet(mesh, bad, {0.9, 1.1}); }, {"strain_limit 0", "positive"});
    expect_refusal([&] { VolumeSet(mesh, 1.0, {bad, 1.1}); }, {"volume: limits", "0 < min <= max"});
  }
  Eigen::VectorXd each = Eigen::VectorXd::Ones(5);
  each[3] = -2.0;
  expect_refusal([&] { TetrahedronSet(mesh, each); }, {"tetrahedron 3", "-2"});
  expect_refusal([&] { VolumeSet(mesh, each); }, {"volume 3", "-2"});
  expect_refusal([&] { TetrahedronSet(mesh, Eigen::VectorXd::Ones(4)); }, {"4", "5 tetrahedra"});
  expect_refusal([&] { VolumeSet(mesh, 1.0, {1.2, 1.1}); }, {"1.2 to 1.1"});
  const auto limits = [&](double min, double max) {
    expect_refusal(
        [&] {
          StrainLimitSet(mesh, 1.0, {min, max});
        },
        {"strain_limit", "0 < min <= 1 <= max"});
  };
  limits(0.0, 1.1);
  limits(1.05, 1.1);
  limits(0.9, 0.95);
  limits(0.9, std::nan(""));
  limits(std::nan(""), 1.1);
}

TEST(TetrahedronSet, RefusesBadMeshes) {
  TetrahedralMesh mesh = make_block({{1, 1, 1}, {2, 1, 1}});
  std::swap(mesh.tetrahedra(0, 7), mesh.tetrahedra(1, 7));
  expect_refusal([&] { TetrahedronSet(mesh, 1.0); }, {"tetrahedron: 1", "inverted", ": 7"});
  expect_refusal([&] { VolumeSet(mesh, 1.0); }, {"volume: 1", "inverted", ": 7"});
  expect_refusal([&] { StrainLimitSet(mesh, 1.0, {0.9, 1.1}); }, {"strain_limit: 1", "inverted"});
}

}  // namespace
}  // namespace pliant
