// Solving with the stiffness of elastic bodies: exact, and in few iterations whatever their size,
// slenderness and stiffness.
#include "pliant/solvers/linear/hessian_solver.h"

#include <gtest/gtest.h>

#include "pliant/math/dense_factors.h"
#include "support/random.h"
#include "support/solvers/system_model.h"
#include "support/worlds/solid_world.h"

namespace pliant::hessian_solver_test {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

Eigen::Matrix3Xd random_vectors(int count, unsigned seed) {
  return Random(seed).positions(count, 1.0);
}

BlockCholesky::Block random_block(unsigned seed) {
  const Eigen::Matrix3Xd numbers = random_vectors(12, seed);
  return Eigen::Map<const BlockCholesky::Block>(numbers.data());
}

/// A diagonally dominant matrix with blocks at `pairs`, in a factor and as it is.
Eigen::MatrixXd fill(int size, const Pairs& pairs, BlockCholesky& factor) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6 * size, 6 * size);
  factor.analyze(size, pairs);
  factor.begin();
  unsigned seed = 1;
  for (const auto& [row, column] : pairs) {
    const BlockCholesky::Block block = random_block(seed++);
    factor.add(row, column, block);
    dense.block<6, 6>(6 * row, 6 * column) += block;
    dense.block<6, 6>(6 * column, 6 * row) += block.transpose();
  }
  for (int i = 0; i < size; ++i) {
    BlockCholesky::Block block = random_block(seed++);
    block = (block + block.transpose()).eval() + 40.0 * BlockCholesky::Block::Identity();
    factor.add(i, i, block);
    dense.block<6, 6>(6 * i, 6 * i) += block;
  }
  return dense;
}

TEST(BlockCholesky, SolvesWhatAFullFactorSolves) {
  const Pairs pairs = {{0, 1}, {4, 1}, {2, 5}, {5, 0}, {3, 2}, {6, 3}, {6, 1}};
  BlockCholesky factor;
  const Eigen::MatrixXd dense = fill(7, pairs, factor);
  factor.factor();
  const Eigen::Matrix3Xd numbers = random_vectors(14, 99);
  BlockCholesky::Vector v = Eigen::Map<const BlockCholesky::Vector>(numbers.data(), 6, 7);
  const Eigen::VectorXd right = Eigen::Map<Eigen::VectorXd>(v.data(), v.size());
  factor.solve(v);
  const Eigen::VectorXd exact = DenseLdlt(dense).solve(right);
  EXPECT_LE((Eigen::Map<Eigen::VectorXd>(v.data(), v.size()) - exact).norm(), 1e-12);
}

TEST(BlockCholesky, UnknownsWithoutStiffnessStayZero) {
  BlockCholesky factor;
  factor.analyze(2, {});
  factor.begin();
  factor.add(0, 0, BlockCholesky::Block::Identity());
  // Of rank 5: nothing holds the third unknown.
  Eigen::Matrix<double, 6, 1> stiffness;
  stiffness << 2.0, 4.0, 0.0, 1.0, 8.0, 5.0;
  factor.add(1, 1, stiffness.asDiagonal().toDenseMatrix());
  factor.factor();
  BlockCholesky::Vector v = BlockCholesky::Vector::Ones(6, 2);
  factor.solve(v);
  EXPECT_LE((v.col(0) - BlockCholesky::Vector::Ones(6, 1)).norm(), 1e-15);
  Eigen::Matrix<double, 6, 1> exact;
  exact << 0.5, 0.25, 0.0, 1.0, 0.125, 0.2;
  EXPECT_LE((v.col(1) - exact).norm(), 1e-15);
}

/// A clamped bar of cubes of side `side` [m], turned out of the axes.
struct Bar {
  Bar(std::array<int, 3> cells, double side, double young, double poisson)
      : model({part(cells, side, young, poisson)}) {
    Particles& particles = system().particles;
    const Positions at_rest = model.tetrahedra()->vertices;
    const double end = at_rest.row(0).minCoeff();
    for (int i = 0; i < particles.size(); ++i) {
      if (at_rest(0, i) < end + 1e-9) particles.fix(i);
    }
  }
  static SolidPart part(std::array<int, 3> cells, double side, double young, double poisson) {
    SolidPart part;
    BlockOptions options;
    options.size = side * Eigen::Vector3d(cells[0], cells[1], cells[2]);
    options.cells = Eigen::Vector3i(cells[0], cells[1], cells[2]);
    part.rest = make_block(options);
    part.pose.rotate(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized()));
    part.material = {young, poisson, 1000.0};
    return part;
  }
  ProjectiveSystem& system() { return static_cast<ProjectiveSystem&>(model.system()); }
  Eigen::Matrix3Xd weight() {
    Eigen::Matrix3Xd f = Eigen::Matrix3Xd::Zero(3, system().particles.size());
    for (int i = 0; i < f.cols(); ++i) {
      if (!system().particles.is_fixed(i)) f(2, i) = -9.81 * system().particles.mass[i];
    }
    return f;
  }
  SolidModel model;
};

struct BarCase {
  std::array<int, 3> cells;
  double young, poisson;
  int iterations;
};

class HessianSolverOn : public testing::TestWithParam<BarCase> {};
INSTANTIATE_TEST_SUITE_P(
    Bars, HessianSolverOn,
    testing::Values(BarCase{{16, 2, 2}, 1e4, 0.3, 20}, BarCase{{16, 2, 2}, 1e8, 0.3, 20},
                    BarCase{{64, 2, 2}, 2e6, 0.3, 20}, BarCase{{64, 2, 2}, 1e8, 0.45, 28},
                    BarCase{{64, 4, 4}, 1e8, 0.3, 20}, BarCase{{16, 16, 16}, 1e6, 0.3, 20},
                    BarCase{{20, 20, 20}, 1e6, 0.45, 28}));

// Slenderness to 1:32, 320 to 40,000 tetrahedra; nearly incompressible ones take a few more.
TEST_P(HessianSolverOn, TakesFewIterationsToAThousandth) {
  const BarCase& c = GetParam();
  Bar bar(c.cells, 0.01, c.young, c.poisson);
  const ProjectiveSystem& system = bar.system();
  HessianSolver solver;
  solver.assemble(system, system.particles.x, system.particles.mass / (0.01 * 0.01),
                  Definiteness::kExact);
  solver.use_rows();
  Eigen::Matrix3Xd exact = bar.weight(), found = exact, product;
  ASSERT_TRUE(solver.solve(1e-9, exact));
  solver.multiply(exact, product);
  for (int i = 0; i < product.cols(); ++i) {
    if (system.particles.is_fixed(i)) product.col(i).setZero();
  }
  EXPECT_LE((product - bar.weight()).norm(), 1e-6 * bar.weight().norm());
  ASSERT_TRUE(solver.solve(1e-3, found));
  EXPECT_LE((found - exact).norm(), 1e-3 * exact.norm());
  EXPECT_LE(solver.iterations(), c.iterations);
}

// A body is solved for as exactly whatever lies beside it in the system: a bar of half a gram
// beside a block of 60 kg, both held at an end and loaded by their weight.
TEST(HessianSolver, LightBodiesBesideHeavyOnesAreSolvedFor) {
  SolidPart block = Bar::part({6, 6, 6}, 0.05, 1e7, 0.3),
            bar = Bar::part({48, 2, 2}, 0.002, 1e6, 0.3);
  block.material.density = 2000.0;
  SolidModel model({block, bar});
  auto& system = static_cast<ProjectiveSystem&>(model.system());
  Particles& particles = system.particles;
  for (int part = 0; part < 2; ++part) {
    for (int i = model.first(part); i < model.first(part) + 4; ++i) particles.fix(i);
  }
  Eigen::Matrix3Xd weight = Eigen::Matrix3Xd::Zero(3, particles.size());
  for (int i = 0; i < particles.size(); ++i) {
    if (!particles.is_fixed(i)) weight(2, i) = -9.81 * particles.mass[i];
  }
  HessianSolver solver;
  solver.assemble(system, particles.x, particles.mass / (0.01 * 0.01), Definiteness::kExact);
  solver.use_rows();
  Eigen::Matrix3Xd exact = weight, found = weight;
  ASSERT_TRUE(solver.solve(1e-10, exact));
  ASSERT_TRUE(solver.solve(0.01, found));
  for (int part = 0; part < 2; ++part) {
    const auto off = (found - exact).middleCols(model.first(part), model.count(part)).norm();
    const auto all = exact.middleCols(model.first(part), model.count(part)).norm();
    EXPECT_LE(off, 0.02 * all) << part;
  }
}

TEST(HessianSolver, TellsWhatParticlesAnswerAlone) {
  Bar bar({4, 2, 2}, 0.01, 1e6, 0.3);
  const ProjectiveSystem& system = bar.system();
  const Eigen::VectorXd inertia = system.particles.mass / (0.01 * 0.01);
  HessianSolver solver;
  solver.assemble(system, system.particles.x, inertia, Definiteness::kExact);
  std::vector<Eigen::Matrix3d> answers;
  solver.find_own_answers(inertia, answers);
  ASSERT_EQ(answers.size(), static_cast<std::size_t>(system.particles.size()));
  for (int i = 0; i < system.particles.size(); ++i) {
    if (system.particles.is_fixed(i)) continue;
    for (int k = 0; k < 3; ++k) {
      Eigen::Matrix3Xd moved = Eigen::Matrix3Xd::Zero(3, system.particles.size()), forces;
      moved.col(i) = answers[static_cast<std::size_t>(i)].col(k);
      solver.multiply(moved, forces);
      // Eigenvalues in closed form are exact to half of the digits.
      EXPECT_LE((forces.col(i) - Eigen::Vector3d::Unit(k)).norm(), 1e-7) << i;
    }
  }
}

TEST(HessianSolver, HoldsDirections) {
  Bar bar({6, 2, 2}, 0.01, 1e6, 0.3);
  const ProjectiveSystem& system = bar.system();
  HessianSolver solver;
  solver.assemble(system, system.particles.x, system.particles.mass / (0.01 * 0.01),
                  Definiteness::kExact);
  const int tip = system.particles.size() - 1;
  solver.rows().begin_row(1e9);
  solver.rows().add(tip, Eigen::Vector3d::UnitZ());
  solver.use_rows();
  Eigen::Matrix3Xd d = bar.weight();
  ASSERT_TRUE(solver.solve(1e-10, d));
  EXPECT_LE(std::abs(d(2, tip)), 1e-5 * d.row(2).cwiseAbs().maxCoeff());
  // The row is as good as another stiffness: the residual with it vanishes.
  Eigen::Matrix3Xd product;
  solver.multiply(d, product);
  solver.rows().add_product(d, product);
  for (int i = 0; i < product.cols(); ++i) {
    if (system.particles.is_fixed(i)) product.col(i).setZero();
  }
  EXPECT_LE((product - bar.weight()).norm(), 1e-6 * bar.weight().norm());
}

// A row of springs that is squeezed to a half gives way sideways.
TEST(HessianSolver, SaysWhereTheMatrixIsNotPositiveDefinite) {
  Positions x = Positions::Zero(3, 5);
  for (int i = 0; i < 5; ++i) x(0, i) = 0.5 * i;
  SystemModel model(x);
  model.add("row", {{0, 1, 1.0, 1e4}, {1, 2, 1.0, 1e4}, {2, 3, 1.0, 1e4}, {3, 4, 1.0, 1e4}});
  const auto& system = static_cast<const ProjectiveSystem&>(model.system());
  HessianSolver solver;
  for (const auto definiteness : {Definiteness::kExact, Definiteness::kProjected}) {
    solver.assemble(system, x, Eigen::VectorXd::Ones(5), definiteness);
    solver.use_rows();
    Eigen::Matrix3Xd d = random_vectors(5, 4);
    EXPECT_EQ(solver.solve(1e-6, d), definiteness == Definiteness::kProjected);
  }
}

/// A sheet of springs, an odd number of particles, soft against folding, and springs along
/// directions between particles far from each other.
struct TiedSheet {
  TiedSheet() : model(flat()) {
    std::vector<Spring> springs;
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        if (i + 1 < kSide) springs.push_back({at(i, j), at(i + 1, j), 0.01, 1e6});
        if (j + 1 < kSide) springs.push_back({at(i, j), at(i, j + 1), 0.01, 1e6});
        if (i + 2 < kSide) springs.push_back({at(i, j), at(i + 2, j), 0.02, 1.0});
        if (j + 2 < kSide) springs.push_back({at(i, j), at(i, j + 2), 0.02, 1.0});
      }
    }
    model.add("sheet", springs);
  }
  static int at(int i, int j) { return kSide * i + j; }
  static Positions flat() {
    Positions x(3, kSide * kSide);
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) x.col(at(i, j)) << 0.01 * i, 0.01 * j, 1e-3 * ((i + j) % 2);
    }
    return x;
  }
  const ProjectiveSystem& system() const {
    return static_cast<const ProjectiveSystem&>(model.system());
  }
  const Particles& particles() const { return system().particles; }
  /// Springs from the `first` particle on to those that lie opposite.
  void tie(int first, int count, HeldRows& rows) const {
    rows.clear();
    for (int k = first; k < first + count; ++k) {
      rows.begin_row(1e5);
      rows.add(k, Eigen::Vector3d::UnitZ());
      rows.add(kSide * kSide - 1 - k, -Eigen::Vector3d::UnitZ());
    }
  }
  void assemble(HessianSolver& solver) const {
    solver.assemble(system(), particles().x, Eigen::VectorXd::Constant(kSide * kSide, 1.0),
                    Definiteness::kProjected);
  }
  static constexpr int kSide = 11;
  SystemModel model;
};

/// |b − (A + Jᵀ S J) d| / |b|.
double residual(const HessianSolver& solver, const Eigen::Matrix3Xd& d, const Eigen::Matrix3Xd& b) {
  Eigen::Matrix3Xd product;
  solver.multiply(d, product);
  solver.rows().add_product(d, product);
  return (product - b).norm() / b.norm();
}

/// The identity and what `add` adds to it.
template <class F>
BlockMatrix matrix_of(const TiedSheet& sheet, const F& add) {
  const int n = TiedSheet::kSide * TiedSheet::kSide;
  BlockMatrix matrix;
  do {
    matrix.begin(sheet.particles(), Eigen::VectorXd::Ones(n));
    add(matrix);
  } while (!matrix.finish());
  return matrix;
}

TEST(PairCholesky, SolvesWithSpringsBetweenDistantParticles) {
  const TiedSheet sheet;
  const Particles& particles = sheet.particles();
  const BlockMatrix matrix = matrix_of(sheet, [&](BlockMatrix& m) {
    for (const auto& set : sheet.system().elements) {
      set->add_stiffness(particles.x, Definiteness::kProjected, m);
    }
  });
  PairCholesky factor;
  factor.prepare(matrix);
  HeldRows rows;
  for (const int first : {0, 7}) {
    sheet.tie(first, 9, rows);
    factor.analyze(matrix, rows);
    ASSERT_TRUE(factor.factor(matrix, rows));
    const Eigen::Matrix3Xd b = random_vectors(particles.size(), 3);
    Eigen::Matrix3Xd d(3, particles.size()), product;
    factor.solve(b, d);
    matrix.multiply(d, product);
    rows.add_product(d, product);
    EXPECT_LE((product - b).norm(), 1e-9 * b.norm());
  }
}

TEST(PairCholesky, KeepsItsFactorWhileAnotherIsAnalyzed) {
  const TiedSheet sheet;
  const Particles& particles = sheet.particles();
  const BlockMatrix matrix = matrix_of(sheet, [](BlockMatrix&) {});
  PairCholesky factor;
  factor.prepare(matrix);
  factor.analyze(matrix, {});
  ASSERT_TRUE(factor.factor(matrix, {}));
  HeldRows rows;
  sheet.tie(0, 3, rows);
  factor.analyze(matrix, rows);
  const Eigen::Matrix3Xd b = random_vectors(particles.size(), 3);
  Eigen::Matrix3Xd d(3, particles.size());
  factor.solve(b, d);
  EXPECT_LE((d - b).norm(), 1e-12 * b.norm());
}

TEST(PairCholesky, SaysWhereTheMatrixIsNotPositiveDefinite) {
  const BlockMatrix matrix =
      matrix_of({}, [](BlockMatrix& m) { m.add(4, 4, -2.0 * Eigen::Matrix3d::Identity()); });
  PairCholesky factor;
  factor.prepare(matrix);
  factor.analyze(matrix, {});
  EXPECT_FALSE(factor.factor(matrix, {}));
}

// Iterations with two levels take more than a hundred; a factor takes their place, and serves the
// matrices with other springs too.
TEST(HessianSolver, FactorsWhereThatIsSooner) {
  TiedSheet sheet;
  HessianSolver solver;
  solver.begin_step(true, true);
  sheet.assemble(solver);
  const Eigen::Matrix3Xd b = random_vectors(TiedSheet::kSide * TiedSheet::kSide, 5);
  for (const int first : {0, 1, 3}) {
    sheet.tie(first, 6, solver.rows());
    solver.use_rows();
    Eigen::Matrix3Xd d = b;
    ASSERT_TRUE(solver.solve(1e-12, d));
    EXPECT_LE(residual(solver, d, b), 1e-7) << first;
    EXPECT_LE(solver.iterations(), first == 0 ? 60 : 16) << first;
  }
  solver.begin_step(false, false);
  solver.use_rows();
  Eigen::Matrix3Xd d = b;
  ASSERT_TRUE(solver.solve(1e-12, d));
  EXPECT_GT(solver.iterations(), 100);
}

// A matrix that turns out not to be positive definite does not end the factors of the step.
TEST(HessianSolver, FactorsAfterOneThatWasNotPositiveDefinite) {
  const TiedSheet sheet;
  const Eigen::Matrix3Xd b = random_vectors(TiedSheet::kSide * TiedSheet::kSide, 7);
  Positions squeezed = sheet.particles().x;
  squeezed *= 0.9;
  HessianSolver solver;
  solver.begin_step(true, true);
  for (const auto definiteness : {Definiteness::kExact, Definiteness::kProjected}) {
    solver.assemble(sheet.system(), squeezed, Eigen::VectorXd::Constant(squeezed.cols(), 1e4),
                    definiteness);
    sheet.tie(0, 6, solver.rows());
    solver.use_rows();
    Eigen::Matrix3Xd d = b;
    EXPECT_EQ(solver.solve(1e-12, d), definiteness == Definiteness::kProjected);
  }
  EXPECT_LE(solver.iterations(), 60);
}

TEST(HessianSolver, AStepDoesNotHangOnFactorsOfTheOneBefore) {
  TiedSheet sheet;
  HessianSolver used, fresh;
  for (HessianSolver* solver : {&used, &fresh}) solver->begin_step(true, true);
  sheet.assemble(used);
  sheet.assemble(fresh);
  const Eigen::Matrix3Xd b = random_vectors(TiedSheet::kSide * TiedSheet::kSide, 6);
  sheet.tie(2, 8, used.rows());
  used.use_rows();
  Eigen::Matrix3Xd d = b;
  ASSERT_TRUE(used.solve(1e-12, d));
  used.begin_step(true, true);
  sheet.assemble(used);
  Eigen::Matrix3Xd again = b, first = b;
  for (HessianSolver* solver : {&used, &fresh}) {
    sheet.tie(0, 6, solver->rows());
    solver->use_rows();
    ASSERT_TRUE(solver->solve(1e-12, solver == &used ? again : first));
  }
  EXPECT_EQ(again, first);
}

}  // namespace
}  // namespace pliant::hessian_solver_test
