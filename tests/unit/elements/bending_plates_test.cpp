#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "pliant/elements/cloth/bending_set.h"
#include "pliant/geometry/mesh/grid.h"
#include "pliant/geometry/mesh/sheet_meshes.h"
#include "pliant/math/symmetric_eigen.h"
#include "support/expect_refusal.h"
#include "support/meshes/sheet_triangulations.h"
#include "support/random.h"

namespace pliant::bending_plates_test {
namespace {

std::unique_ptr<BendingSet> plates(const TriangleMesh& mesh, double stiffness) {
  return BendingSet::plates(mesh, Eigen::Vector3d::UnitX(), stiffness, stiffness);
}

TEST(BendingPlates, OneTriangleAloneDoesNotBend) {
  TriangleMesh one;
  one.vertices = Eigen::Matrix3d::Identity();
  one.triangles.resize(3, 1);
  one.triangles << 0, 1, 2;
  EXPECT_EQ(plates(one, 1.0)->name(), "bending");
  EXPECT_EQ(plates(one, 1.0)->size(), 0);
}

TEST(BendingPlates, AffineMapsOfTheRestStateCostNothing) {
  Random random(3);
  for (const Triangulation kind : kTriangulations) {
    const TriangleMesh mesh = triangulated({1.0, 0.7, 6, 5}, kind);
    const auto set = plates(mesh, 2.0);
    for (int trial = 0; trial < 20; ++trial) {
      Eigen::Matrix3d map;
      for (int k = 0; k < 3; ++k) map.col(k) = random.vector(2.0);
      const Positions x = (map * mesh.vertices).colwise() + random.vector(5.0);
      Forces f = Forces::Zero(3, 30);
      set->add_forces(x, f);
      // Coefficients of some 1000 N/m times differences that are rounded to 1e-15 of 10 m.
      EXPECT_LE(f.norm(), 1e-8) << name_of(kind);
      EXPECT_LE(set->energy(x), 1e-18) << name_of(kind);
    }
  }
}

/// z = (p x² + q y²)/2 + r x y.
Positions curved(const TriangleMesh& mesh, double p, double q, double r) {
  Positions x = mesh.vertices;
  x.row(2) = 0.5 * p * x.row(0).array().square() + 0.5 * q * x.row(1).array().square() +
             r * x.row(0).array() * x.row(1).array();
  return x;
}

TEST(BendingPlates, IsTheOrthotropicPlateOnEveryMesh) {
  // A patch test: constant curvature is met to round-off, and in equilibrium but for moments at
  // edges: what is some cells off the edge feels no force.
  const GridOptions grid{1.3, 1.2, 14, 13};
  const double warp = 3e-3, weft = 1e-3, p = 0.03, q = -0.02, r = 0.05;
  const double plate =
      1.56 * (0.5 * warp * p * p + 0.5 * weft * q * q + std::sqrt(warp * weft) * r * r);
  const auto expect_plate = [&](const BendingSet& set, const TriangleMesh& mesh, const char* name) {
    const Positions x = curved(mesh, p, q, r);
    EXPECT_NEAR(set.energy(x), plate, 1e-11 * plate) << name;
    Forces f = Forces::Zero(3, x.cols());
    set.add_forces(x, f);
    int inner = 0;
    for (int i = 0; i < x.cols(); ++i) {
      if (mesh.vertices.col(i).lpNorm<Eigen::Infinity>() > 0.15) continue;
      ++inner;
      EXPECT_LE(f.col(i).norm(), 1e-9 * f.colwise().norm().maxCoeff()) << name;
    }
    EXPECT_GE(inner, 3) << name;
  };
  expect_plate(BendingSet(grid, warp, weft), make_grid(grid), "grid");
  for (const Triangulation kind : kTriangulations) {
    const TriangleMesh mesh = triangulated(grid, kind);
    expect_plate(*BendingSet::plates(mesh, {1.0, 0.0, 0.0}, warp, weft), mesh, name_of(kind));
  }
}

TEST(BendingPlates, WarpMayRunAnywhere) {
  const double warp = 4e-3, weft = 1e-3;
  const TriangleMesh mesh = triangulated({1.0, 1.0, 9, 9}, Triangulation::kIrregular);
  const auto along_x = BendingSet::plates(mesh, {1.0, 0.0, 0.0}, warp, weft);
  const auto along_y = BendingSet::plates(mesh, {0.0, 5.0, 0.3}, warp, weft);
  const Positions x = curved(mesh, 0.02, 0.0, 0.0), y = curved(mesh, 0.0, 0.02, 0.0);
  EXPECT_NEAR(along_x->energy(x) / along_x->energy(y), 4.0, 1e-9);
  EXPECT_NEAR(along_y->energy(y) / along_y->energy(x), 4.0, 1e-9);
  EXPECT_NEAR(along_x->energy(x), along_y->energy(y), 1e-12 * along_x->energy(x));
}

TEST(BendingPlates, OfATubeThatWasSewnKeepsTheFlatStatesEnergy) {
  // 1/2 B A / R², to the second order of the cells.
  const double radius = 0.1, stiffness = 2e-4;
  double errors[2];
  for (int k = 0; k < 2; ++k) {
    const TriangleMesh mesh = make_tube({radius, 0.3, 48 << k, 24 << k});
    const double plate = 0.5 * stiffness * 2.0 * M_PI * 0.3 / radius;
    errors[k] = std::abs(plates(mesh, stiffness)->energy(mesh.vertices) / plate - 1.0);
  }
  EXPECT_LE(errors[0], 1e-3);
  EXPECT_LE(errors[1], 0.3 * errors[0]);
}

/// A sheet rolled onto a cylinder of that radius, keeping lengths, about an axis at right angles to
/// the direction of that angle.
Positions rolled(const TriangleMesh& flat, double radius, double direction) {
  const Eigen::Vector3d along(std::cos(direction), std::sin(direction), 0.0);
  const Eigen::Vector3d across(-along.y(), along.x(), 0.0);
  Positions x = flat.vertices;
  for (int i = 0; i < x.cols(); ++i) {
    const double angle = along.dot(flat.vertices.col(i)) / radius;
    x.col(i) = radius * std::sin(angle) * along + across.dot(flat.vertices.col(i)) * across +
               radius * (1.0 - std::cos(angle)) * Eigen::Vector3d::UnitZ();
  }
  return x;
}

TEST(BendingPlates, ARolledSheetHasThePlatesEnergyInEveryDirection) {
  const double stiffness = 2e-3, radius = 1.0;
  const auto expect_plate = [&](const auto& make, const char* name) {
    for (const double direction : {0.0, M_PI / 4.0, M_PI / 2.0}) {
      double errors[2];
      for (const int cells : {20, 40}) {
        const GridOptions grid{1.0, 0.5, cells + 1, cells / 2 + 1};
        const auto [mesh, set] = make(grid);
        const double plate = 0.5 * stiffness * 0.5 / (radius * radius);
        const double energy = set->energy(rolled(mesh, radius, direction));
        errors[cells / 20 - 1] = std::abs(energy / plate - 1.0);
      }
      // Chords instead of arcs: of the order of (h / R)², 2.5e-3 and 6e-4.
      EXPECT_LE(errors[0], 2.5e-3) << name << " at " << direction;
      EXPECT_LE(errors[1], 0.5 * errors[0]) << name << " at " << direction;
    }
  };
  expect_plate(
      [&](const GridOptions& grid) {
        return std::make_pair(make_grid(grid),
                              std::make_unique<BendingSet>(grid, stiffness, stiffness));
      },
      "grid");
  for (const Triangulation kind : kTriangulations) {
    expect_plate(
        [&](const GridOptions& grid) {
          const TriangleMesh mesh = triangulated(grid, kind);
          return std::make_pair(mesh, plates(mesh, stiffness));
        },
        name_of(kind));
  }
}

/// Both matrices, one number a pair of particles, which all three coordinates have.
class Dense final : public SystemMatrix, public StiffnessMatrix {
 public:
  explicit Dense(Eigen::Index n) : values(Eigen::MatrixXd::Zero(n, n)) {}
  void add(int row, int column, double stiffness) override { values(row, column) += stiffness; }
  void add(int row, int column, const Eigen::Matrix3d& block) override {
    values(row, column) += block(0, 0);
  }
  Eigen::MatrixXd values;
};

TEST(BendingPlates, TheConstantMatrixIsStifferAndHasNoMoreEntriesThanThatOfHinges) {
  for (const Triangulation kind : kTriangulations) {
    const TriangleMesh mesh = triangulated({1.0, 0.5, 9, 6}, kind);
    const auto set = BendingSet::plates(mesh, {1.0, 0.2, 0.0}, 2.0, 0.5);
    Dense constant(mesh.vertices.cols()), stiffness(mesh.vertices.cols());
    set->add_to_system(constant);
    set->add_stiffness(mesh.vertices, Definiteness::kExact, stiffness);
    EXPECT_EQ(constant.values, constant.values.transpose()) << name_of(kind);
    const double size = stiffness.values.cwiseAbs().maxCoeff();
    EXPECT_LE(constant.values.rowwise().sum().cwiseAbs().maxCoeff(), 1e-12 * size);
    const Eigen::VectorXd more = symmetric_eigenvalues(constant.values - stiffness.values);
    EXPECT_GE(more.minCoeff(), -1e-12 * size) << name_of(kind);
    std::set<std::pair<int, int>> pairs;
    for (const BendingHinge& hinge : hinges_of_mesh(mesh, {1.0, 0.0, 0.0}, {1.0, 1.0})) {
      for (const int i : hinge.vertices) {
        for (const int j : hinge.vertices) pairs.emplace(i, j);
      }
    }
    int elsewhere = 0, of_stiffness = 0;
    for (int i = 0; i < constant.values.rows(); ++i) {
      for (int j = 0; j < constant.values.cols(); ++j) {
        if (pairs.count({i, j}) > 0) continue;
        elsewhere += constant.values(i, j) != 0.0;
        of_stiffness += stiffness.values(i, j) != 0.0;
      }
    }
    EXPECT_EQ(elsewhere, 0) << name_of(kind);
    EXPECT_GT(of_stiffness, 0) << name_of(kind) << ": else this tests nothing";
  }
}

TEST(BendingPlates, RefusesBadStiffness) {
  const TriangleMesh mesh = make_grid({1.0, 1.0, 3, 3});
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal([&] { plates(mesh, bad); }, {"bending stiffness", "N m", "positive"});
    expect_refusal(
        [&] {
          BendingSet(GridOptions{1.0, 1.0, 3, 3}, 1.0, bad);
        },
        {"bending stiffness", "N m", "positive"});
  }
}

}  // namespace
}  // namespace pliant::bending_plates_test
