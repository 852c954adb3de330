#pragma once

#include <vector>

#include "pliant/solvers/linear/aggregation.h"

namespace pliant {

/// Weights of Chebyshev's semi-iteration z ← z + momentum (z − z₋) + pull D⁻¹ (q − A z), one of
/// each a sweep.
struct Smoother {
  static constexpr int kSweeps = 2;  ///< before and after a coarser level
  // Eigenvalues of D⁻¹A below the largest one over this are left to the coarser levels.
  static constexpr double kRange = 4.0;

  std::vector<double> momentum, pull;
};
/// For eigenvalues of D⁻¹A between these.
Smoother make_smoother(double least, double largest, int sweeps);

/// A matrix and what ties it to the coarser one.
struct MultigridLevel {
  SparseRows a;              ///< n x n [N/m]
  SparseRows prolongation;   ///< n x the coarser n; of no columns where there is no coarser one
  SparseRows restriction;    ///< its transpose
  Eigen::VectorXd diagonal;  ///< of a
  Smoother smoother;
  bool is_coarsest = false;  ///< of so few unknowns that the smoother alone solves

  bool has_coarser() const { return prolongation.cols() > 0; }
};

/// Coarser and coarser forms of a matrix by smoothed aggregation (Vaněk, Mandel and Brezina 1996),
/// and a V-cycle on them in place of its inverse. The cycle is symmetric and positive definite: it
/// smooths as much after as before. Its rate depends little on the size of a mesh: what is long on
/// a fine mesh is short on a coarse one. The same bits for any number of threads.
class Multigrid {
 public:
  static constexpr int kMostCoarsest = 32;    ///< unknowns of the coarsest matrix
  static constexpr int kCoarsestSweeps = 12;  ///< on it

  /// `largest` eigenvalue of D⁻¹A, where it is known; 0: it is not.
  explicit Multigrid(SparseRows a, double largest = 0.0);

  const std::vector<MultigridLevel>& levels() const { return levels_; }
  /// Entries of all matrices over those of the finest.
  double complexity() const;
  /// v <- B v, the cycle's approximation of A⁻¹ v.
  void solve(Eigen::Matrix3Xd& v) const;

 private:
  Eigen::Matrix3Xd cycle(std::size_t level, const Eigen::Matrix3Xd& q) const;

  std::vector<MultigridLevel> levels_;
};

}  // namespace pliant
