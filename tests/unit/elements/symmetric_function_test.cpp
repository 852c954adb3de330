#include "pliant/elements/solids/symmetric_function.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "support/random.h"

namespace pliant {
namespace {

Eigen::Matrix3d with_eigenvalues(const Eigen::Matrix3d& q, const Eigen::Vector3d& lambda) {
  const Eigen::Matrix3d s = q * lambda.asDiagonal() * q.transpose();
  return 0.5 * (s + s.transpose());
}

/// Far apart, close together, two or three alike.
std::vector<Eigen::Vector3d> spectra() {
  std::vector<Eigen::Vector3d> all{{1, 1, 1}, {1.5, 1, 1}, {1.5, 1.5, 1}, {2, 1, 0.5}, {3, -1, -4}};
  for (const double e : {1e-1, 1e-4, 1e-8, 1e-12, 1e-16}) {
    all.push_back({1.0 + e, 1.0, 1.0 - e});
    all.push_back({1.0 + e, 1.0 + 0.5 * e * e, 1.0});
    all.push_back({2.0, 1.0 + e, 1.0});
    all.push_back({2.0 + e, 2.0, 1.0});
  }
  return all;
}

TEST(SymmetricFunction, EigenvaluesHaveTheRightSums) {
  Random random(5);
  for (const Eigen::Vector3d& lambda : spectra()) {
    const Eigen::Matrix3d s = with_eigenvalues(random.rotation(), lambda);
    const Eigen::Vector3d found = symmetric_eigenvalues(s);
    const double size = lambda.cwiseAbs().maxCoeff(), spread = lambda[0] - lambda[2];
    EXPECT_NEAR(found.sum(), lambda.sum(), 4e-15 * size);
    EXPECT_NEAR(found.prod(), lambda.prod(), 2e-14 * size * size * size);
    EXPECT_LE((found - lambda).cwiseAbs().maxCoeff(), 4e-15 * size + 1e-7 * spread);
    EXPECT_GE(found[0], found[1] - 1e-15 * size);
    EXPECT_GE(found[1], found[2] - 1e-15 * size);
  }
}

TEST(SymmetricFunction, IsThatOfTheEigenvectors) {
  Random random(6);
  for (const Eigen::Vector3d& lambda : spectra()) {
    const Eigen::Matrix3d q = random.rotation();
    const Eigen::Matrix3d s = with_eigenvalues(q, lambda);
    const Eigen::Vector3d found = symmetric_eigenvalues(s);
    const auto function = [](double x) { return 1.0 / (5.0 + x) + std::exp(0.5 * x); };
    const Eigen::Matrix3d expected = with_eigenvalues(q, lambda.unaryExpr(function));
    const auto derivative = [](double x) {
      return -1.0 / ((5.0 + x) * (5.0 + x)) + 0.5 * std::exp(0.5 * x);
    };
    const Eigen::Matrix3d value =
        symmetric_function(s, found, found.unaryExpr(function), found.unaryExpr(derivative));
    EXPECT_LE((value - expected).norm(), 2e-14 * expected.norm()) << lambda.transpose();
  }
}

TEST(SymmetricFunction, OfNothingIsItsValue) {
  const Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
  EXPECT_EQ(symmetric_eigenvalues(s), Eigen::Vector3d::Zero());
  EXPECT_EQ(symmetric_function(s, Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(2.0),
                               Eigen::Vector3d::Ones()),
            Eigen::Matrix3d(2.0 * Eigen::Matrix3d::Identity()));
}

}  // namespace
}  // namespace pliant
