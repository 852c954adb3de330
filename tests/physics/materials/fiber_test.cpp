// Fibres in an elastic bar: Young's modulus at any angle to them.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/elements/solids/fiber_set.h"
#include "support/solvers/statics.h"
#include "support/worlds/solids.h"

namespace pliant::fiber_test {
namespace {

constexpr double kYoung = 2e5, kFiber = 6e5;  // [Pa]
const BlockOptions kBar{{0.3, 0.2, 0.2}, {4, 3, 3}};

/// Stress of a bar along x that is stretched by `strain`, with fibres in the plane of x and y. The
/// bar is free to contract and to shear: x = const stays plane, what leans is y over x.
double stress(double angle, double strain) {
  const TetrahedralMesh mesh = jittered_block(kBar, 0.2);
  const int n = static_cast<int>(mesh.vertices.cols());
  auto sets = make_solid(mesh, {kYoung, 0.0, 1000.0});
  sets.push_back(std::make_unique<FiberSet>(
      mesh, kFiber, Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)));
  Statics statics(pointers(sets), n);
  Positions x = mesh.vertices;
  statics.fix(0);
  for (int i = 0; i < n; ++i) {
    if (on_face(mesh, i, 2, -1)) statics.fix(i, 2);
    if (on_face(mesh, i, 0, -1)) statics.fix(i, 0);
    if (!on_face(mesh, i, 0, 1)) continue;
    statics.fix(i, 0);
    x(0, i) += strain * kBar.size[0];
  }
  statics.solve(x);
  const Forces f = statics.forces(x);
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    if (on_face(mesh, i, 0, 1)) sum -= f(0, i);
  }
  return sum / (kBar.size[1] * kBar.size[2]);
}

TEST(Fibers, AddTheirStiffnessAlongThemAndNoneAcross) {
  // Both energies are quadratic in the stretches: exact at any strain, until fibres in compression
  // buckle, where k e / (1 - e) reaches the shear modulus E / 2.
  for (const double strain : {-0.1, -0.01, 0.01, 0.3}) {
    EXPECT_NEAR(stress(0.0, strain), (kYoung + kFiber) * strain, 1e-9 * kYoung) << strain;
    EXPECT_NEAR(stress(0.5 * M_PI, strain), kYoung * strain, 1e-9 * kYoung) << strain;
  }
}

TEST(Fibers, YoungsModulusAtAnAngle) {
  // With the stiffness E I + k A A, A = a aᵀ, the compliance is (I - k/(E + k) A A) / E, so that
  //   1/E(θ) = (1 - k/(E + k) cos⁴θ) / E.
  const double e = 1e-4;
  for (const double angle : {0.2, M_PI / 4.0, 1.2}) {
    // What is even in the strain cancels; the rest is e².
    const double modulus = (stress(angle, e) - stress(angle, -e)) / (2.0 * e);
    const double expected =
        kYoung / (1.0 - kFiber / (kYoung + kFiber) * std::pow(std::cos(angle), 4));
    EXPECT_NEAR(modulus / expected, 1.0, 1e-6) << angle;
  }
}

}  // namespace
}  // namespace pliant::fiber_test
