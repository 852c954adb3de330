#pragma once

#include <vector>

#include "pliant/solvers/linear/projective_matrix.h"

namespace pliant {

/// Groups of particles no two of which share an entry of a matrix, and the rest.
struct VertexColoring {
  std::vector<std::vector<int>> colors;
  std::vector<int> overflow;  ///< those that no colour had room for
};

/// Balanced greedy colouring: each free particle takes the emptiest colour that none of its
/// neighbours has. With `max_colors` > 0 there are no more than that, and particles left over go to
/// the overflow; with 0 there are as many as it takes.
VertexColoring color_vertices(const SparseRows& a, const Particles& particles, int max_colors);

/// Σ |A_ij| over the others of the overflow for one of it, 0 for all others: what its diagonal
/// lacks to bound A where all of the overflow moves at the same time [N/m].
Eigen::VectorXd overflow_row_sums(const SparseRows& a, const VertexColoring& coloring);

}  // namespace pliant
