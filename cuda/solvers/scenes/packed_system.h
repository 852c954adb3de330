#pragma once

#include <string>
#include <vector>

#include "cuda/core/vector.h"
#include "cuda/elements/cluster_list.h"
#include "cuda/solvers/matrix/packed_matrix.h"
#include "cuda/solvers/matrix/packed_rows.h"
#include "cuda/solvers/step_state.h"
#include "pliant/core/system/system.h"

namespace pliant {

/// Simplices as blocks of particles compute them: each block lists every element that touches one
/// of its particles. Arrays of four numbers an element lie one after the other: a load each.
struct PackedSimplices {
  int corners = 0;              ///< 4 or 3
  int quads = 0;                ///< arrays in `numbers`
  std::vector<int> begins;      ///< first element of each pass of each block, and the end
  std::vector<UShort4> places;  ///< of the corners, numbered within the block (BlockBorders)
  std::vector<UShort4> slots;  ///< where in the block a corner's force goes; kNoSlot: nobody's here
  /// Tetrahedra and fibres: gradients of vertices 1 to 3, weight, λ/μ. Triangles: likewise of
  /// vertices 1 and 2, weight, number in `materials`.
  std::vector<Float4> numbers;

  static constexpr unsigned short kNoSlot = 0xffff;
  int size() const { return static_cast<int>(places.size()); }
};

/// A projective system as a GPU reads it: single precision, particles in blocks (vertex_blocks.h),
/// and everything that one particle needs gathered by itself, so that no two threads add to one
/// number. Elements at the border of blocks are computed by each of them: that costs a little
/// arithmetic and saves writing and reading all forces.
struct PackedSystem {
  int particles = 0;
  int block = 0;  ///< particles in a block
  int blocks = 0;
  std::vector<int> order;  ///< particle of each place
  std::vector<int> place;  ///< place of each particle
  BlockBorders borders;    ///< of what springs, cells, bending and simplices read
  LocalRows springs;       ///< a: rest length, b: stiffness
  LocalRows cells;         ///< a: the ends of the other diagonal (PlacePair), b: stiffness
  LocalRows quadratic;     ///< b: coefficient of x_j - x_i
  PackedSimplices tetrahedra, fibers, triangles;
  ClusterList clusters;
  PackedMatrix matrix;  ///< of iterations that need it; pack() makes none
  std::vector<MembraneConstants<float>> materials;
  /// A block computes its simplices in so many parts, 1 or 2, which use the same slots one after
  /// the other: what a multiprocessor shares among its blocks then holds more of them.
  int passes = 1;
  std::vector<int> slot_begins;  ///< of each place, within its block; block + 1 numbers a pass
  int most_slots = 0;            ///< of a pass
  /// First block of each scene, and the end; of more than one in a joined system.
  std::vector<int> scene_begins;
  /// All scenes of a joined system read the elements of the first one, which has so many blocks;
  /// 0: each reads its own.
  int shared_blocks = 0;

  int scenes() const { return static_cast<int>(scene_begins.size()) - 1; }
};

/// Why a GPU cannot take the system: the first element set or constraint that has no device form;
/// empty where it can.
std::string why_not_packed(const ProjectiveSystem& system);

/// Throws InputError with why_not_packed().
PackedSystem pack(const ProjectiveSystem& system, int block, int passes = 1);

/// What pack() depends on besides positions, where a system has clusters and attachments alone:
/// another one after any change. Empty where it has other elements, which do not tell.
std::vector<long> structure_of(const ProjectiveSystem& system);
/// What the orientations of particles add to the moments of the packed clusters (list_spins()).
/// Empty where none are oriented.
void pack_spins(const ProjectiveSystem& system, const PackedSystem& packed,
                std::vector<float>& spins);
/// Packs the clusters anew: shapes may creep while all else stays.
void pack_clusters(const ProjectiveSystem& system, PackedSystem& packed);

}  // namespace pliant
