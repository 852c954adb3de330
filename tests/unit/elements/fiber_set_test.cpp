// Fibres by themselves; what they share with other sets is tested with those.
#include "pliant/elements/solids/fiber_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <new>

#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/solvers/matrices.h"

namespace pliant {
namespace {

TetrahedralMesh block() {
  Random random(3);
  TetrahedralMesh mesh = make_block({{0.2, 0.1, 0.1}, {2, 1, 1}});
  mesh.vertices += random.positions(static_cast<int>(mesh.vertices.cols()), 0.01);
  return mesh;
}

TEST(FiberSet, OnlyTheLengthAlongTheFibreCosts) {
  const TetrahedralMesh mesh = block();
  const double volume = volumes(mesh).sum();
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d along = random.vector(1.0);
    const FiberSet set(mesh, 300.0, along);
    Eigen::Matrix3d map = random.rotation() * random(0.1, 2.0);
    for (double& entry : map.reshaped()) entry += random(-0.5, 0.5);
    const double stretch = (map * along.normalized()).norm() - 1.0;
    EXPECT_NEAR(set.energy(map * mesh.vertices), 0.5 * 300.0 * volume * stretch * stretch,
                1e-12 * volume * 300.0);
    // A map that leaves the fibre alone costs nothing, however it squeezes what is across.
    const Eigen::Vector3d a = along.normalized(), across = a.unitOrthogonal();
    const Eigen::Matrix3d squeeze =
        random.rotation() * (Eigen::Matrix3d::Identity() - 0.9 * across * across.transpose());
    EXPECT_NEAR(set.energy(squeeze * mesh.vertices), 0.0, 1e-25);
  }
}

TEST(FiberSet, TheDirectionsLengthAndSenseDoNotMatter) {
  const TetrahedralMesh mesh = block();
  const Positions x = Eigen::Vector3d(1.3, 0.8, 1.1).asDiagonal() * mesh.vertices;
  const Eigen::Vector3d along(1.0, 2.0, -1.0);
  const Forces f = forces_of(FiberSet(mesh, 300.0, along), x);
  for (const double factor : {-1.0, 1e-160, 1e160}) {
    EXPECT_LE((forces_of(FiberSet(mesh, 300.0, factor * along), x) - f).norm(), 1e-13 * f.norm());
  }
}

TEST(FiberSet, TheSystemMatrixIsTheStiffnessAlongTheFibre) {
  const TetrahedralMesh mesh = block();
  const Eigen::Vector3d along = Eigen::Vector3d(1.0, 2.0, -1.0).normalized();
  const FiberSet set(mesh, 300.0, along);
  const int n = static_cast<int>(mesh.vertices.cols());
  const Eigen::MatrixXd system = system_of(set, n), k = stiffness_of(set, mesh.vertices);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      EXPECT_NEAR(along.dot(k.block<3, 3>(3 * i, 3 * j) * along), system(i, j),
                  1e-12 * system.norm());
    }
  }
}

TEST(FiberSet, CollapsedFibresAreFiniteAndSpringBack) {
  TetrahedralMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 0.1, 0.02, 0.03,  //
      0, 0.01, 0.09, 0.02,              //
      0, 0.0, 0.01, 0.11;
  mesh.tetrahedra = Eigen::Vector4i(0, 1, 2, 3);
  FiberSet set(mesh, 300.0, Eigen::Vector3d::UnitX());
  const auto diagonal = [](double a, double b, double c) {
    return Eigen::Matrix3d(Eigen::Vector3d(a, b, c).asDiagonal());
  };
  for (const Eigen::Matrix3d& map :
       {diagonal(0, 1, 1), diagonal(0, 0, 1), diagonal(0, 0, 0), diagonal(1e-200, 1, 1),
        diagonal(1e-12, 1, 1), diagonal(-1e-9, 1e-9, 0)}) {
    Positions x = map * mesh.vertices;
    const double start = set.energy(x);
    EXPECT_NEAR(start, 0.5 * 300.0 * volumes(mesh).sum(), 1e-8);
    EXPECT_TRUE(forces_of(set, x).allFinite()) << map;
    EXPECT_TRUE(stiffness_of(set, x).allFinite()) << map;
    const Eigen::MatrixXd projected = stiffness_of(set, x, Definiteness::kProjected);
    EXPECT_GE(least_eigenvalue(projected), -1e-12 * projected.norm()) << map;
    for (int step = 0; step < 200; ++step) {
      set.reset_multipliers();
      set.relax(Eigen::VectorXd::Constant(4, 1e3), 1.0, x);
    }
    EXPECT_LE(set.energy(x), 1e-9 * start) << map;
  }
}

TEST(FiberSet, ItsTangentDoesNotDependOnWhereTheGradientLies) {
  Random random(8);
  alignas(16) double memory[10];
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
    for (double& entry : map.reshaped()) entry += random(-0.5, 0.5);
    // At an address that is a multiple of 16, and at one that is not.
    const auto tangent_at = [&](double* place) {
      auto& g = *new (place) Eigen::Matrix3d(map);
      return FiberLaw().tangent(g, Definiteness::kExact);
    };
    EXPECT_EQ(tangent_at(memory), tangent_at(memory + 1));
  }
}

TEST(FiberSet, RefusesBadInput) {
  TetrahedralMesh mesh = block();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, std::nan(""), infinity}) {
    expect_refusal([&] { FiberSet(mesh, bad, x); }, {"fiber 0", "Pa", "positive"});
  }
  expect_refusal([&] { FiberSet(mesh, 1.0, Eigen::Vector3d::Zero()); },
                 {"fiber: direction is (0, 0, 0)", "not 0"});
  for (const double bad : {std::nan(""), infinity}) {
    expect_refusal([&] { FiberSet(mesh, 1.0, {0.0, bad, 0.0}); }, {"fiber: direction", "finite"});
  }
  std::swap(mesh.tetrahedra(0, 7), mesh.tetrahedra(1, 7));
  expect_refusal([&] { FiberSet(mesh, 1.0, x); }, {"fiber: 1", "inverted", ": 7"});
}

}  // namespace
}  // namespace pliant
