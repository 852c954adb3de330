#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/system/neighbor_lists.h"

namespace pliant {

/// The particles in and about one cube of space, side by side, for sums over them at points of that
/// cube. Lengths are in edges of a cube, from its lowest corner; of single precision, since they
/// are small.
class NearbyParticles {
 public:
  /// `weights` by rank. Fast where the next call's cube comes a little after this one's.
  void gather(const NeighborLists& lists, const Eigen::VectorXf& weights,
              const NeighborLists::Cell& cell);

  /// Of the kernels, in edges of the cubes: at most 1, as at first.
  void set_radius(float radius) { sharpness_ = 1.0f / (radius * radius); }
  /// Σ w (1 − (r/radius)²)³ over those nearer than the radius to `point`.
  float sum(const Eigen::Vector3f& point) const;
  /// The same, and that sum times (x − point).
  float sum(const Eigen::Vector3f& point, Eigen::Vector3f& offsets) const;
  /// The mean of `values`, a column for each particle, with these weights; 0 where there are none.
  Eigen::VectorXd mean(const Eigen::Vector3f& point, const Eigen::MatrixXd& values);

 private:
  using Array = Eigen::ArrayXf;
  void weigh(const Eigen::Vector3f& point);

  int count_ = 0;
  float sharpness_ = 1.0f;
  Array x_, y_, z_, weight_, kernel_;
  const NeighborLists* lists_ = nullptr;
  NeighborLists::Rows rows_{};
  NeighborLists::RowHints hints_;
};

}  // namespace pliant
