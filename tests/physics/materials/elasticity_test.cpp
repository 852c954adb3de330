// Tetrahedra as an elastic body: the material that they are said to be, whatever the mesh.
#include <gtest/gtest.h>

#include "support/random.h"
#include "support/solvers/statics.h"
#include "support/worlds/solids.h"

namespace pliant::elasticity_test {
namespace {

const BlockOptions kBlock{{0.3, 0.2, 0.2}, {4, 3, 3}};

class Elasticity : public testing::TestWithParam<double> {
 protected:
  double poisson() const { return GetParam(); }
  ElasticMaterial material() const { return {2e5, poisson(), 1000.0}; }

  TetrahedralMesh mesh_ = jittered_block(kBlock, 0.2);
  int n_ = static_cast<int>(mesh_.vertices.cols());
  std::vector<std::unique_ptr<ElementSet>> sets_ = make_solid(mesh_, material());
};

INSTANTIATE_TEST_SUITE_P(PoissonsRatio, Elasticity, testing::Values(0.0, 0.3, 0.45, 0.49),
                         [](const auto& info) {
                           return std::to_string(static_cast<int>(100.0 * info.param + 0.5));
                         });

TEST_P(Elasticity, AffineBoundariesMakeAffineBodies) {
  Random random(1);
  Statics statics(pointers(sets_), n_);
  for (int i = 0; i < n_; ++i) {
    if (on_boundary(mesh_, i)) statics.fix(i);
  }
  ASSERT_GT(statics.count(), 0);
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
    for (double& entry : map.reshaped()) entry += random(-0.15, 0.15);
    map = random.rotation() * map;
    const Positions expected = (map * mesh_.vertices).colwise() + random.vector(1.0);
    Positions x = expected;
    for (int i = 0; i < n_; ++i) {
      if (!on_boundary(mesh_, i)) x.col(i) += random.vector(0.01);
    }
    statics.solve(x);
    EXPECT_LE((x - expected).cwiseAbs().maxCoeff(), 1e-12) << map;
  }
}

/// Stretched along x by `strain`, free across: stress along x and strain across.
struct Stretched {
  double stress, across;
};

Stretched stretched(const TetrahedralMesh& mesh, const std::vector<const ElementSet*>& sets,
                    double strain) {
  const int n = static_cast<int>(mesh.vertices.cols());
  Statics statics(sets, n);
  Positions x = mesh.vertices;
  for (int i = 0; i < n; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (on_face(mesh, i, axis, -1)) statics.fix(i, axis);
    }
    if (!on_face(mesh, i, 0, 1)) continue;
    statics.fix(i, 0);
    x(0, i) += strain * kBlock.size[0];
  }
  statics.solve(x);
  const Forces f = statics.forces(x);
  Stretched result{0.0, x(1, n - 1) - mesh.vertices(1, n - 1)};
  result.across /= kBlock.size[1];
  for (int i = 0; i < n; ++i) {
    if (on_face(mesh, i, 0, 1)) result.stress -= f(0, i) / (kBlock.size[1] * kBlock.size[2]);
  }
  return result;
}

TEST_P(Elasticity, MeasuresYoungsModulusAndPoissonsRatio) {
  const double e = 1e-4;  // what is nonlinear is even in it: e²
  const Stretched up = stretched(mesh_, pointers(sets_), e);
  const Stretched down = stretched(mesh_, pointers(sets_), -e);
  EXPECT_NEAR((up.stress - down.stress) / (2.0 * e) / material().young, 1.0, 1e-6);
  EXPECT_NEAR(-(up.across - down.across) / (2.0 * e), poisson(), 1e-6);
}

TEST_P(Elasticity, MeasuresTheShearModulus) {
  const double e = 1e-4;
  Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
  shear(0, 1) = e;
  double energy = 0.0;
  for (const auto& set : sets_) energy += set->energy(shear * mesh_.vertices);
  const double modulus = material().young / (2.0 * (1.0 + poisson()));
  EXPECT_NEAR(energy / (0.5 * e * e * kBlock.size.prod()) / modulus, 1.0, 1e-6);
}

TEST_P(Elasticity, MeasuresTheBulkModulus) {
  const double e = 1e-5;
  const auto energy = [&](double scale) {
    double sum = 0.0;
    for (const auto& set : sets_) sum += set->energy(scale * mesh_.vertices);
    return sum;
  };
  const double modulus = material().young / (3.0 * (1.0 - 2.0 * poisson()));
  const double mean = 0.5 * (energy(1.0 + e) + energy(1.0 - e));
  // The third order cancels in the mean.
  EXPECT_NEAR(mean / (4.5 * e * e * kBlock.size.prod()) / modulus, 1.0, 1e-6);
}

}  // namespace
}  // namespace pliant::elasticity_test
