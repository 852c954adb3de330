#include "pliant/math/symmetric_eigen3.h"

#include <gtest/gtest.h>

#include "support/epsilon.h"
#include "support/random.h"

namespace pliant {
namespace {

void expect_decomposed(const Eigen::Matrix3d& a) {
  const SymmetricEigen3 eigen = symmetric_eigen3(a);
  const double size = a.norm();
  const Eigen::Matrix3d& v = eigen.vectors;
  EXPECT_LE((v.transpose() * v - Eigen::Matrix3d::Identity()).norm(), 10 * kEpsilon);
  EXPECT_LE((v * eigen.values.asDiagonal() * v.transpose() - a).norm(), 20 * kEpsilon * size) << a;
  EXPECT_LE(eigen.values[0], eigen.values[1]);
  EXPECT_LE(eigen.values[1], eigen.values[2]);
}

TEST(SymmetricEigen3, IsExactHoweverCloseEigenvaluesAre) {
  Random random(7);
  for (const double spread : {1.0, 1e-3, 1e-8, 1e-14, 0.0}) {
    for (const double gap : {1.0, 1e-3, 1e-6, 1e-8, 1e-12, 0.0}) {
      for (const double base : {2.0, 0.0, -1.0}) {
        for (int k = 0; k < 100; ++k) {
          Eigen::Vector3d values;
          values << base + spread * random(-1, 1), base + spread * random(-1, 1), 0.0;
          values[2] = values[1] + gap * spread;
          const Eigen::Matrix3d turn = random.rotation();
          const Eigen::Matrix3d a = turn * values.asDiagonal() * turn.transpose();
          expect_decomposed(0.5 * (a + a.transpose()));
        }
      }
    }
  }
}

TEST(SymmetricEigen3, IsExactAtEveryScale) {
  Random random(8);
  for (const double scale : {1e-100, 1e-8, 1.0, 1e8, 1e100}) {
    for (int k = 0; k < 100; ++k) {
      Eigen::Matrix3d a;
      for (int c = 0; c < 3; ++c) a.col(c) = random.vector(scale);
      expect_decomposed(0.5 * (a + a.transpose()));
    }
  }
}

TEST(SymmetricEigen3, OfDiagonalAndZeroMatrices) {
  expect_decomposed(Eigen::Matrix3d::Zero());
  expect_decomposed(Eigen::Matrix3d::Identity());
  expect_decomposed(Eigen::Vector3d(3.0, -1.0, 2.0).asDiagonal());
  expect_decomposed(Eigen::Vector3d(0.0, 0.0, 1.0).asDiagonal());
  EXPECT_EQ(symmetric_eigen3(Eigen::Vector3d(3.0, -1.0, 2.0).asDiagonal()).values,
            Eigen::Vector3d(-1.0, 2.0, 3.0));
}

TEST(SymmetricEigen3, ReadsTheLowerHalf) {
  Eigen::Matrix3d a;
  a << 2.0, 9.0, 9.0, 0.5, 1.0, 9.0, -0.25, 0.125, 3.0;
  const Eigen::Matrix3d whole = a.selfadjointView<Eigen::Lower>();
  EXPECT_EQ(symmetric_eigen3(a).values, symmetric_eigen3(whole).values);
}

}  // namespace
}  // namespace pliant
