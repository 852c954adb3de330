#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/system/point_constraint.h"

namespace pliant {

/// The directions in which contact with what nothing moves holds each piece of a system: the
/// normals of its contacts with obstacles and links that carry force. A piece goes on along them
/// with no velocity that it should not have.
class HeldDirections {
 public:
  /// Of `pieces` pieces; `piece_of` has that of each particle, and -1 of one that is held.
  void find(const PointConstraints& constraints, const std::vector<int>& piece_of, int pieces);
  /// What is left of a piece's `drift` across the directions that hold it.
  Eigen::Vector3d open_part(int piece, const Eigen::Vector3d& drift) const;
  /// Whether contacts press on a piece from opposite sides.
  bool is_gripped(int piece) const;
  /// How hard a piece is gripped depends on nanometres of what grips it, and some more would drop
  /// it: contacts of gripped pieces that carry force are closed from now on.
  void close_grips(const std::vector<int>& piece_of, PointConstraints& constraints) const;
  /// Nothing is held.
  void clear() { spans_.clear(); }

 private:
  /// Orthonormal columns, the first `size` of them.
  struct Span {
    Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
    int size = 0;
    bool is_gripped = false;
    void add(const Eigen::Vector3d& normal);
  };
  std::vector<Span> spans_;
};

}  // namespace pliant
