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

/// Points of the sheet that are held on others of it, as where it is folded: some by one row, some
/// by so many that they are a block.
HeldRows held_on_each_other() {
  HeldRows rows;
  Random random(5);
  for (int k = 0; k < 20; ++k) {
    const int i = k, j = kSide * kSide - 1 - k;
    for (int r = 0; r < (k % 3 == 0 ? 5 : 1); ++r) {
      const Eigen::Vector3d direction = random.vector(1.0);
      rows.begin_row(100.0);
      rows.add(i, direction);
      rows.add(j, -direction);
    }
  }
  rows.merge();
  return rows;
}

TEST(CoarseSpace, KnowsThatPointsHeldOnEachOtherMoveTogether) {
  const Sheet sheet;
  const HeldRows rows = held_on_each_other();
  const auto error = [&](bool ties_rows) {
    CoarseSpace coarse;
    coarse.prepare(sheet.matrix, sheet.particles);
    coarse.begin_step(ties_rows);
    coarse.factor(sheet.matrix, rows, sheet.particles.x);
    Eigen::Matrix3Xd d(3, sheet.particles.size()), product, found(3, sheet.particles.size());
    d.colwise() = Eigen::Vector3d(0.3, -0.2, 0.9);
    sheet.matrix.multiply(d, product);
    rows.add_product(d, product);
    coarse.solve(product);
    for (int i = 0; i < static_cast<int>(found.cols()); ++i) found.col(i) = coarse.correction(i);
    return (found - d).norm() / d.norm();
  };
  EXPECT_LT(error(true), 1e-9);
  EXPECT_GT(error(false), 0.1) << "the test says nothing";
}

TEST(CoarseSpace, ForgetsWhatRowsOfAnotherStepTied) {
  const Sheet sheet;
  CoarseSpace used, fresh;
  for (CoarseSpace* coarse : {&used, &fresh}) {
    coarse->prepare(sheet.matrix, sheet.particles);
    coarse->begin_step(true);
  }
  used.factor(sheet.matrix, held_on_each_other(), sheet.particles.x);
  used.begin_step(true);
  const Eigen::Matrix3Xd r = Random(3).positions(sheet.particles.size(), 1.0);
  for (CoarseSpace* coarse : {&used, &fresh}) {
    coarse->factor(sheet.matrix, HeldRows(), sheet.particles.x);
    coarse->solve(r);
  }
  for (int i = 0; i < sheet.particles.size(); ++i) {
    ASSERT_EQ(used.correction(i), fresh.correction(i)) << "to the bit";
  }
}

}  // namespace
}  // namespace pliant::coarse_space_test
