// A beam of tetrahedra against beam theory, and how fast it gets there.
#include <gtest/gtest.h>

#include <cmath>

#include "support/solids.h"
#include "support/statics.h"

namespace pliant::cantilever_test {
namespace {

constexpr double kLength = 1.0, kHeight = 0.2, kYoung = 1e6, kForce = 1e-3;

/// Mean deflection of the end face under kForce across the beam, clamped at the other end.
double deflection(int cells, double poisson) {
  const TetrahedralMesh mesh = make_block({{kLength, kHeight, kHeight}, {5 * cells, cells, cells}});
  const int n = static_cast<int>(mesh.vertices.cols());
  const auto sets = make_solid(mesh, {kYoung, poisson, 1000.0});
  Statics statics(pointers(sets), n);
  // Shares of the end face's area: 1/4 of a cell at its corners, 1/2 at its sides.
  Eigen::VectorXd share = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) {
    if (on_face(mesh, i, 0, -1)) statics.fix(i);
    if (!on_face(mesh, i, 0, 1)) continue;
    share[i] = 1.0;
    for (int axis = 1; axis < 3; ++axis) {
      if (on_face(mesh, i, axis, -1) || on_face(mesh, i, axis, 1)) share[i] *= 0.5;
    }
  }
  share /= share.sum();
  statics.load.row(2) = kForce * share.transpose();
  Positions x = mesh.vertices;
  statics.solve(x, 1);  // small strains are linear
  EXPECT_LE(statics.residual(x).norm(), 1e-3 * kForce);
  return (x - mesh.vertices).row(2).dot(share);
}

/// P L³ / (3 E I) + P L / (κ G A), κ = 10 (1 + ν) / (12 + 11 ν) (Cowper 1966).
double timoshenko(double poisson) {
  const double area = kHeight * kHeight, moment = area * area / 12.0;
  const double shear = kYoung / (2.0 * (1.0 + poisson));
  const double kappa = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
  return kForce * kLength * kLength * kLength / (3.0 * kYoung * moment) +
         kForce * kLength / (kappa * shear * area);
}

TEST(Cantilever, ConvergesToBeamTheoryWithTheSquareOfTheMesh) {
  // Without Poisson's effect beam theory is exact but for the clamped end's warping, 1e-3.
  const double theory = timoshenko(0.0);
  const double coarse = deflection(2, 0.0), middle = deflection(4, 0.0), fine = deflection(8, 0.0);
  // Displacement elements are too stiff, and the more the coarser.
  EXPECT_LT(coarse, middle);
  EXPECT_LT(middle, fine);
  EXPECT_LT(fine, theory);
  EXPECT_NEAR(std::log2((theory - middle) / (theory - fine)), 2.0, 0.2);
  EXPECT_NEAR((4.0 * fine - middle) / 3.0 / theory, 1.0, 0.01);
}

TEST(Cantilever, PoissonsEffectChangesItAsBeamTheorySays) {
  // The clamped end cannot contract: stiffer than theory by the order of ν² h / L, 2 %.
  const double theory = timoshenko(0.3);
  const double middle = deflection(4, 0.3), fine = deflection(8, 0.3);
  EXPECT_LT(middle, fine);
  EXPECT_NEAR((4.0 * fine - middle) / 3.0 / theory, 0.985, 0.015);
}

}  // namespace
}  // namespace pliant::cantilever_test
