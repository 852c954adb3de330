#pragma once

#include <memory>
#include <vector>

#include "cuda/core/vector.h"
#include "cuda/solvers/matrix/packed_rows.h"
#include "pliant/solvers/linear/multigrid.h"

namespace pliant {

/// A level of Multigrid below the finest, as kernels read it.
struct PackedLevel {
  int rows = 0;
  SlicedRows matrix;            ///< b: A_ij without the diagonal
  SlicedRows restriction;       ///< b: weights of rows of the finer level, or of places
  SlicedRows prolongation;      ///< b: weights of rows of the coarser level
  std::vector<float> diagonal;  ///< A_ii [N/m]
  /// Of each row pull/A_ii of both sweeps, the second one's momentum, Σ_j A_ij. Of the coarsest
  /// one, whose sweeps are those of PackedMultigrid, 1/A_ii instead of the first.
  std::vector<Float4> rule;

  int slices() const { return (rows + SlicedRowsLayout::kSlice - 1) / SlicedRowsLayout::kSlice; }
};

/// Multigrid on the matrix of a packed system. It depends on the time step.
struct PackedMultigrid {
  static constexpr int kUnroll = 8;          ///< of matrices and restrictions
  static constexpr int kProlongUnroll = 4;   ///< of prolongations: their rows are short
  static constexpr int kMostOfBlock = 2048;  ///< rows of a level that one block works on
  static constexpr int kBlockLevels = 4;     ///< of these, the coarsest one among them

  SlicedRows prolongation;          ///< of each place, from the first of `levels`
  std::vector<PackedLevel> levels;  ///< from fine to coarse
  bool has_coarsest = false;        ///< the last one is solved by sweeps with these weights
  float momentum[Multigrid::kCoarsestSweeps] = {}, pull[Multigrid::kCoarsestSweeps] = {};
  int bottom = 0;  ///< first one of those that one block works on
};

/// `order` and `place` as those of a PackedSystem.
PackedMultigrid pack_multigrid(const Multigrid& multigrid, const std::vector<int>& order,
                               const std::vector<int>& place);

/// Of a scene what one block works on: rows in the pool of all levels.
struct CycleBottom {
  static constexpr int kLevels = PackedMultigrid::kBlockLevels;
  int begin[kLevels] = {}, end[kLevels] = {};
  int levels = 0;
  bool has_coarsest = false;
  bool is_fine = false;  ///< the finer level is that of places
  float momentum[Multigrid::kCoarsestSweeps] = {}, pull[Multigrid::kCoarsestSweeps] = {};
};

/// The levels of all scenes of a packed system in one pool of rows: level by level what launches
/// work on, whole slices a scene, then scene by scene what a block works on. Indices are those in
/// the pool, and places of the joined system.
struct MultigridPool {
  SlicedRows fine;  ///< prolongation to each place
  SlicedRows matrix, restriction, prolongation;
  std::vector<float> diagonal;
  std::vector<Float4> rule;
  std::vector<int> scene_of_slice;
  std::vector<int> level_begins = {0};  ///< first row of each launched level, and the end
  std::vector<CycleBottom> bottoms;     ///< one a scene
};

/// What a scene of a packed system has.
struct SceneMultigrid {
  std::shared_ptr<const PackedMultigrid> packed;
  int places = 0;  ///< of the scene, up to the first one of the next scene
};

MultigridPool pool_of(const std::vector<SceneMultigrid>& scenes);

}  // namespace pliant
