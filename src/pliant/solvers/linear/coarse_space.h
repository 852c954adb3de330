#pragma once

#include <Eigen/Core>
#include <set>
#include <utility>
#include <vector>

#include "pliant/solvers/constrained/held_rows.h"
#include "pliant/solvers/linear/block_cholesky.h"
#include "pliant/solvers/linear/block_matrix.h"

namespace pliant {

/// Aggregates of neighbouring particles, each of which moves and turns as a rigid piece: the
/// columns P of a coarse space that keeps the near null space of elastic bodies, and the factor of
/// Pᵀ A P (Vaněk, Mandel and Brezina 1996). Pieces of a body that only move would see bending as
/// shear, which is thousands of times stiffer in a slender one.
class CoarseSpace {
 public:
  /// Forms aggregates in the graph of `matrix`.
  void prepare(const BlockMatrix& matrix, const Particles& particles);
  /// A step begins. Whether its factors have places for what rows tie, which takes memory where
  /// that changes: the sheets of a fold that touch move together. Else a bound counts each of them
  /// as held by itself. Before that, none has.
  void begin_step(bool ties_rows);
  /// Factors Pᵀ (A + Jᵀ K J) P, P at the positions `x`.
  void factor(const BlockMatrix& matrix, const HeldRows& rows, const Positions& x);
  /// P (Pᵀ A P)⁻¹ Pᵀ r, of which correction() tells each particle's.
  void solve(const Eigen::Matrix3Xd& r);
  Eigen::Vector3d correction(int particle) const {
    const int a = of(particle);
    if (a < 0) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d turn = coarse_.col(a).tail<3>();
    return coarse_.col(a).head<3>() + turn.cross(Eigen::Vector3d(arms_.col(particle)));
  }

  /// Multiplications of solve() and of all corrections.
  double work() const {
    return 72.0 * factor_.nonzeros() + 36.0 * count() + 12.0 * static_cast<double>(members_.size());
  }

  int count() const { return static_cast<int>(begins_.size()) - 1; }

 private:
  using Block = BlockCholesky::Block;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  /// Scalars s of a row of the matrix in the columns of one aggregate, whose arms are q.
  struct RowScalars {
    int aggregate;
    double sum;              // Σ s
    Eigen::Vector3d moment;  // Σ s q
  };

  using Pairs = std::set<std::pair<int, int>>;  // of aggregates, the larger one first

  int of(int particle) const { return of_[static_cast<std::size_t>(particle)]; }
  /// Aggregates that share a stiffness, ascending.
  void find_sharing(const SharedStiffnesses& shared, int number);
  void add_shared(const SharedStiffnesses& shared);
  void place(const Positions& x);
  /// What the rows of an aggregate's members add to the factor's matrix.
  void add_members(const BlockMatrix& matrix, int aggregate);
  /// Adds one to the scalars of a row.
  static void add_row_scalar(std::vector<RowScalars>& row, int aggregate, double scalar,
                             const Eigen::Vector3d& arm);
  void add_rows(const HeldRows& rows);
  void add_row(const HeldRows& rows, int row);
  void add_block(const HeldRows& rows, const HeldRows::Block& block);
  /// Calls use(a, b) for every two aggregates that a row ties, the larger one first.
  template <class Use>
  void for_tied(const HeldRows& rows, const Use& use) const;
  void find_pattern(const HeldRows& rows);
  /// At least what rows add, in the places on the diagonal.
  void bound_row(const HeldRows& rows, int row);
  void bound_block(const HeldRows& rows, const HeldRows::Block& block);
  /// How many aggregates a row touches, and whether one of its entries is the first of its own.
  int touched(const HeldRows& rows, int row) const;
  bool is_first(const HeldRows& rows, int row, const HeldRows::Entry* e) const;

  // Aggregates that elements tie, and rows of the step besides; the larger one first.
  std::vector<std::pair<int, int>> tied_by_elements_, pattern_;
  bool ties_rows_ = false, has_rows_ = false;         // in this step; the factor's pattern
  std::vector<int> of_;                               // aggregate of each particle; -1: none
  std::vector<int> begins_, members_;                 // of each aggregate
  Eigen::Matrix3Xd arms_;                             // from centres, over the aggregates' sizes
  std::vector<std::vector<RowScalars>> row_scalars_;  // of each aggregate; kept for its memory
  std::vector<int> sharing_;                          // of one shared stiffness: its aggregates
  std::vector<Block> shares_;                         // and their motions along its own
  BlockCholesky factor_;
  BlockCholesky::Vector coarse_;
};

}  // namespace pliant
