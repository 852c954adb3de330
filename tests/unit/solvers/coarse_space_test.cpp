#include "pliant/solvers/linear/coarse_space.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <memory>

#include "pliant/elements/cloth/bending_set.h"
#include "pliant/geometry/mesh/grid.h"
#include "support/random.h"

namespace pliant::coarse_space_test {
namespace {

constexpr int kSide = 14;
constexpr double kInertia = 1e-3;  // [N/m]

/// A sheet of plates whose vertices are off their places, some of them with blocks that are no
/// multiples of the identity besides.
struct Sheet {
  Sheet() {
    TriangleMesh mesh = make_grid({0.4, 0.4, kSide, kSide});
    Random random(8);
    mesh.vertices.topRows(2) += random.positions(kSide * kSide, 0.004).topRows(2);
    bending = BendingSet::plates(mesh, Eigen::Vector3d::UnitX(), 1e-4, 3e-5);
    particles = Particles(mesh.vertices, Eigen::VectorXd::Ones(kSide * kSide));
    do {
      matrix.begin(particles, Eigen::VectorXd::Constant(kSide * kSide, kInertia));
      bending->add_stiffness(particles.x, Definiteness::kExact, matrix);
      add_bars(matrix);
    } while (!matrix.finish());
  }

  /// Between neighbours of a row, each along a direction of its own.
  static void add_bars(StiffnessMatrix& k) {
    Random random(21);
    for (int i = 0; i + 1 < kSide * kSide; ++i) {
      const Eigen::Vector3d along = random.vector(0.1);
      const Eigen::Matrix3d block = along * along.transpose();
      k.add(i, i, block);
      k.add(i + 1, i + 1, block);
      k.add(i, i + 1, -block);
      k.add(i + 1, i, -block);
    }
  }

  std::unique_ptr<BendingSet> bending;
  Particles particles;
  BlockMatrix matrix;
};

// With P the coarse space and q the coefficients of a displacement d = P q,
// P (Pᵀ A P)⁻¹ Pᵀ A d = P q: so what lies in the space is found exactly, and an entry that entered
// the coarse matrix wrongly shows. Motions of the whole sheet lie in it.
TEST(CoarseSpace, FindsRigidMotionsExactlyOfBlocksAndOfScalars) {
  const Sheet sheet;
  ASSERT_GT(sheet.matrix.scalars(), 4 * kSide * kSide) << "the test says nothing of scalars";
  CoarseSpace coarse;
  coarse.prepare(sheet.matrix, sheet.particles);
  ASSERT_GT(coarse.count(), 3);
  coarse.factor(sheet.matrix, HeldRows(), sheet.particles.x);
  Random random(2);
  const Eigen::Vector3d shift = random.vector(1.0), turn = random.vector(3.0);
  Eigen::Matrix3Xd d(3, sheet.particles.size()), product;
  for (int i = 0; i < d.cols(); ++i) {
    d.col(i) = shift + turn.cross(Eigen::Vector3d(sheet.particles.x.col(i)));
  }
  sheet.matrix.multiply(d, product);
  Eigen::Matrix3Xd found = Eigen::Matrix3Xd::Zero(3, d.cols());
  coarse.solve(product);
  for (int i = 0; i < static_cast<int>(found.cols()); ++i) found.col(i) = coarse.correction(i);
  EXPECT_NEAR((found - d).norm(), 0.0, 1e-9 * d.norm());
}

}  // namespace
}  // namespace pliant::coarse_space_test
