#pragma once

#include <vector>

#include "pliant/solvers/linear/projective_matrix.h"

namespace pliant {

/// Unknowns of a symmetric matrix put together to those of a coarser one.
struct Aggregation {
  static constexpr int kNone = -1;  ///< relaxation alone solves for such an unknown

  std::vector<int> of;  ///< aggregate of each row
  int count = 0;
};

/// Aggregates of neighbours that are tied strongly, seen from at least one of them: by an entry
/// below zero of no less than a share of the row's largest. Positive entries, as bending has them,
/// tie nobody. Rows in which the diagonal rules, such as those of fixed particles and of inertia,
/// are left out; every aggregate has at least two members, so that a coarser matrix has at most
/// half of the rows. In the order of rows, whatever the number of threads (Vaněk, Mandel and
/// Brezina 1996, algorithm 5.1).
Aggregation aggregate(const SparseRows& a);

/// Interpolation from aggregates to rows, n x count: constant within each aggregate, then smoothed
/// by one Jacobi iteration on the strong entries alone. Its rows have no negative entries and a sum
/// of 1 (of 0 where a row has no aggregate).
SparseRows smoothed_prolongation(const SparseRows& a, const Aggregation& aggregation);

/// A B, each row by one thread in a fixed order.
SparseRows product(const SparseRows& a, const SparseRows& b);

}  // namespace pliant
