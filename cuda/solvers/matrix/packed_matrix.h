#pragma once

#include <vector>

#include "cuda/solvers/matrix/packed_multigrid.h"
#include "cuda/solvers/matrix/packed_rows.h"
#include "pliant/solvers/device/device_iteration.h"
#include "pliant/solvers/linear/vertex_coloring.h"

namespace pliant {

struct PackedSystem;

/// The matrix A of projective dynamics as iterations of line_search_jacobi, sweeps and lbfgs read
/// it, in the order of a packed system. None of its numbers depends on the time step, but for
/// multigrid.
struct PackedMatrix {
  static constexpr int kUnroll = 8;       ///< of whole rows
  static constexpr int kSweepUnroll = 4;  ///< of a sweep's: they are about half as long

  DeviceIteration::Kind kind = DeviceIteration::kJacobi;  ///< which needs none
  /// b: A_ij [N/m]. Weighted and quasi-Newton: of each place without its diagonal. Sweeps: of each
  /// of `members`, those entries alone that meet particles which the sweep has moved before.
  SlicedRows rows;
  std::vector<float> held;  ///< likewise: Σ_j A_ij − M/h² of each place [N/m]
  /// Sweeps: the place of each row, or -1. A level is a colour, or the overflow as the last one;
  /// the first colour needs no rows.
  std::vector<int> members;
  std::vector<int> level_begins = {0};     ///< first row of each level and the end; whole slices
  std::vector<float> overflow_sums;        ///< of each place, see overflow_row_sums() [N/m]
  int colors = 0, overflow = 0;            ///< particles in the overflow
  int history = 0, sweeps = 0;             ///< quasi-Newton: DeviceIteration
  std::vector<SceneMultigrid> multigrids;  ///< one a scene; empty: sweeps alone

  int levels() const { return static_cast<int>(level_begins.size()) - 1; }
};

/// Of `a`, whose fixed particles' rows are those of the identity; `inertia` M/h² [N/m].
PackedMatrix pack_whole(const SparseRows& a, const DeviceIteration& iteration,
                        const Eigen::VectorXd& inertia, const PackedSystem& packed);
PackedMatrix pack_sweep(const SparseRows& a, const VertexColoring& coloring,
                        const PackedSystem& packed);

/// Matrices of one kind, those of the systems that join() puts one after the other.
PackedMatrix join_matrices(const std::vector<const PackedSystem*>& systems);

}  // namespace pliant
