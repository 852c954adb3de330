#pragma once

#include "pliant/core/body/particles.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// Looks for strong compression of tetrahedra, a part of them in each step so that it costs little:
/// all have been seen after kRound steps.
class StretchWatch {
 public:
  static constexpr int kRound = 16;

  explicit StretchWatch(const TetrahedralMesh& rest);

  int size() const { return static_cast<int>(tetrahedra_.cols()); }
  /// Deformation gradient of a tetrahedron.
  Eigen::Matrix3d gradient(int tetrahedron, const Positions& x) const;
  /// Looks at the next part; returns the smallest principal stretch that the last kRound calls
  /// saw.
  double look(const Positions& x);
  void reset();

 private:
  Eigen::Matrix4Xi tetrahedra_;
  Eigen::Matrix3Xd inverses_;  // of the rest sides [1/m], three columns a tetrahedron
  Eigen::Matrix<double, kRound, 1> smallest_;
  int next_ = 0;
};

}  // namespace pliant
