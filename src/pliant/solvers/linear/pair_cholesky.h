#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "pliant/solvers/constrained/held_rows.h"
#include "pliant/solvers/linear/block_cholesky.h"
#include "pliant/solvers/linear/block_matrix.h"

namespace pliant {

/// The factor of a matrix of particles and of springs along directions, A + Jᵀ S J, in blocks of
/// two neighbouring particles each. Springs on many particles are left out of it.
class PairCholesky {
 public:
  /// The matrix has another pattern.
  void prepare(const BlockMatrix& matrix);
  /// Forgets which springs there were: what comes does not hang on what was before.
  void forget();
  /// Takes the pattern of the matrix and of these springs, and of those before. What was factored
  /// stays until something else is.
  void analyze(const BlockMatrix& matrix, const HeldRows& rows);
  /// Multiplications that factor() takes, and solve(), of the pattern that was analysed last.
  double work_of_factor() const { return work_of_factor_; }
  double work_of_solve() const { return work_of_solve_; }
  /// Of springs that analyze() saw. False where the matrix is not positive definite.
  bool factor(const BlockMatrix& matrix, const HeldRows& rows);
  /// z = (A + Jᵀ S J)⁻¹ r.
  void solve(const Eigen::Matrix3Xd& r, Eigen::Matrix3Xd& z);

 private:
  /// A particle's place: that of its pair, and 0 or 3 in it.
  struct Place {
    int pair, first;
  };
  Place of(int particle) const { return places_[static_cast<std::size_t>(particle)]; }
  void add(int row, int column, const Eigen::Matrix3d& block);
  void add_rows(const HeldRows& rows);
  /// Calls f(pair, pair) of every two pairs that the springs tie.
  template <class F>
  void for_tied(const HeldRows& rows, const F& f) const;

  std::vector<Place> places_;
  int count_ = 0;             // of pairs
  std::vector<int> singles_;  // pairs of one particle
  int blocks_ = 0;            // of the matrix
  std::vector<std::pair<int, int>> pattern_;
  bool is_analyzed_ = false;  // since forget()
  bool has_next_ = false;     // an analysis that nothing was factored with
  double work_of_factor_ = 0.0, work_of_solve_ = 0.0;
  BlockCholesky factor_, next_;
  BlockCholesky::Vector solution_;
};

}  // namespace pliant
