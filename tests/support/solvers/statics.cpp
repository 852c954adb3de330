#include "support/solvers/statics.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

struct Entries final : StiffnessMatrix {
  explicit Entries(const std::vector<bool>& free) : numbers(free.size()) {
    for (std::size_t k = 0, n = 0; k < free.size(); ++k) {
      numbers[k] = free[k] ? static_cast<int>(n++) : -1;
    }
  }
  void add(int row, int column, const Eigen::Matrix3d& block) override {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const int r = numbers[static_cast<std::size_t>(3 * row + i)];
        const int c = numbers[static_cast<std::size_t>(3 * column + j)];
        if (r >= 0 && c >= 0) triplets.emplace_back(r, c, block(i, j));
      }
    }
  }
  std::vector<int> numbers;
  std::vector<Eigen::Triplet<double>> triplets;
};

}  // namespace

double Statics::energy(const Positions& x) const {
  double sum = -load.cwiseProduct(x).sum();
  for (const ElementSet* set : sets_) sum += set->energy(x);
  return sum;
}

Forces Statics::forces(const Positions& x) const {
  Forces f = load;
  for (const ElementSet* set : sets_) set->add_forces(x, f);
  return f;
}

Eigen::VectorXd Statics::residual(const Positions& x) const {
  const Forces f = forces(x);
  Eigen::VectorXd result(count());
  for (int k = 0, n = 0; k < f.size(); ++k) {
    if (free_[static_cast<std::size_t>(k)]) result[n++] = f.data()[k];
  }
  return result;
}

Eigen::SparseMatrix<double> Statics::stiffness(const Positions& x,
                                               Definiteness definiteness) const {
  Entries entries(free_);
  for (const ElementSet* set : sets_) set->add_stiffness(x, definiteness, entries);
  Eigen::SparseMatrix<double> k(count(), count());
  k.setFromTriplets(entries.triplets.begin(), entries.triplets.end());
  return k;
}

void Statics::move(const Eigen::VectorXd& step, Positions& x) const {
  for (int k = 0, n = 0; k < x.size(); ++k) {
    if (free_[static_cast<std::size_t>(k)]) x.data()[k] += step[n++];
  }
}

double Statics::solve(Positions& x, int steps) const {
  for (int step = 0; step < steps; ++step) {
    const Eigen::VectorXd r = residual(x);
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(stiffness(x, Definiteness::kExact));
    if (factor.info() != Eigen::Success) {
      Eigen::SparseMatrix<double> k = stiffness(x, Definiteness::kProjected);
      double largest = 0.0;
      for (int n = 0; n < k.cols(); ++n) largest = std::max(largest, k.coeff(n, n));
      for (int n = 0; n < k.cols(); ++n) k.coeffRef(n, n) += 1e-9 * largest;
      factor.compute(k);
    }
    if (!search(factor.solve(r), r, x)) break;
  }
  return residual(x).norm();
}

bool Statics::search(const Eigen::VectorXd& step, const Eigen::VectorXd& r, Positions& x) const {
  const double start = energy(x);
  for (double share = 1.0; share > 1e-9; share *= 0.5) {
    Positions moved = x;
    move(share * step, moved);
    const double change = energy(moved) - start;
    const bool falls = change < -1e-4 * share * step.dot(r) && change < -1e-13 * std::abs(start);
    if (falls || residual(moved).norm() < 0.9 * r.norm()) {
      x = moved;
      return true;
    }
  }
  return false;
}

}  // namespace pliant
