// Bodies of tetrahedra from the worst states, by local and global steps alone.
#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/math/dense_factors.h"
#include "support/random.h"
#include "support/solvers/matrices.h"
#include "support/worlds/solids.h"

namespace pliant::scramble_test {
namespace {

constexpr double kCell = 0.2 / 3.0;

/// A free body, hardly held by a spring on every vertex so that the matrix can be factored.
class ScrambledBody {
 public:
  explicit ScrambledBody(double poisson) : sets_(make_solid(rest_, {1e5, poisson, 1000.0})) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n_, n_);
    for (const auto& set : sets_) a += system_of(*set, n_);
    a.diagonal().array() += 1e-6 * a.diagonal().mean();
    factor_.compute(a);
  }

  double energy() const {
    double sum = 0.0;
    for (const auto& set : sets_) sum += set->energy(x);
    return sum;
  }
  /// How many tetrahedra are inside out.
  long inverted() const { return (volumes({x, rest_.tetrahedra}).array() < 0.0).count(); }
  void scramble(double size, int seed) {
    x = Random(static_cast<std::uint64_t>(seed)).positions(n_, size);
  }
  void disturb(double size, int seed) {
    scramble(size, seed);
    x += rest_.vertices;
  }
  /// One local step (the forces) and one global step.
  void iterate() {
    Forces f = Forces::Zero(3, n_);
    for (const auto& set : sets_) set->add_forces(x, f);
    x += factor_.solve(Eigen::MatrixXd(f.transpose())).transpose();
  }
  /// Iterates until the body is at rest, or not.
  void relax(int iterations) {
    for (int k = 0; k < iterations && energy() > 1e-18; ++k) iterate();
  }

  Positions x;

 private:
  TetrahedralMesh rest_ = jittered_block({{0.2, 0.2, 0.2}, {3, 3, 3}}, 0.2);
  int n_ = static_cast<int>(rest_.vertices.cols());
  std::vector<std::unique_ptr<ElementSet>> sets_;
  DenseCholesky factor_;
};

TEST(Scramble, RandomPositionsReturnToRest) {
  ScrambledBody body(0.0);
  for (const double size : {0.001, 0.03, 0.1, 10.0}) {
    for (int seed = 0; seed < 6; ++seed) {
      body.scramble(size, seed);
      ASSERT_GT(body.inverted(), 40);
      body.relax(1000);
      EXPECT_LE(body.energy(), 1e-18) << "seed " << seed << ", size " << size;
    }
  }
}

TEST(Scramble, WithVolumeATenthInsideOutReturnsToRest) {
  for (const double poisson : {0.3, 0.45}) {
    ScrambledBody body(poisson);
    for (int seed = 0; seed < 6; ++seed) {
      body.disturb(0.75 * kCell, seed);
      ASSERT_GT(body.inverted(), 13);
      body.relax(3000);
      EXPECT_LE(body.energy(), 1e-18) << "seed " << seed << ", Poisson's ratio " << poisson;
    }
  }
}

TEST(Scramble, EveryIterationLowersTheEnergy) {
  // From random positions a nearly incompressible body may end in a tangle, but it gets no worse.
  ScrambledBody body(0.45);
  for (int seed = 0; seed < 3; ++seed) {
    body.scramble(0.1, seed);
    const double start = body.energy();
    double last = start;
    for (int k = 0; k < 500; ++k) {
      body.iterate();
      const double energy = body.energy();
      ASSERT_LE(energy, last * (1.0 + 1e-12)) << seed << " " << k;
      last = energy;
    }
    EXPECT_LE(last, 0.2 * start);
  }
}

}  // namespace
}  // namespace pliant::scramble_test
