#pragma once

#include <Eigen/Geometry>

#include "pliant/core/body/embedded_points.h"
#include "pliant/models/reduced/reduced_model.h"

namespace pliant {

/// The vertices of a reduced body in the world: x = X + U q, v = U p. Sums run in an order that
/// does not depend on the number of threads.
class ReducedVertices {
 public:
  explicit ReducedVertices(const ReducedModel& model);

  int size() const { return static_cast<int>(rest_.cols()); }
  int rank() const { return static_cast<int>(rows_.rows()); }
  const Eigen::Matrix3Xd& rest() const { return rest_; }  ///< X [m]
  /// Turns X and U, and moves X.
  void place(const Eigen::Isometry3d& world_from_body);

  void positions(const Eigen::VectorXd& q, Positions& x) const;
  void velocities(const Eigen::VectorXd& p, Eigen::Matrix3Xd& v) const;
  /// Uᵀ f of 3 x n forces [N].
  void reduce(const Forces& forces, Eigen::VectorXd& reduced);
  /// Uᵀ of a force on a vertex, in each axis: r x 3.
  auto rows(int vertex) const { return rows_.middleCols<3>(3 * vertex); }
  /// Uᵀ of a force that acts on an embedded point, in each axis: r x 3, to `rows`.
  void rows_of(const EmbeddedPoints& points, int point, Eigen::Ref<Eigen::MatrixXd> rows) const;

 private:
  void apply(const Eigen::VectorXd& coordinates, const Eigen::Matrix3Xd* offset,
             Eigen::Matrix3Xd& result) const;

  Eigen::Matrix3Xd rest_;
  Eigen::MatrixXd columns_;  // U: 3n x r
  Eigen::MatrixXd rows_;     // Uᵀ: r x 3n, three columns a vertex
  Eigen::MatrixXd parts_;    // of reduce(): r x blocks
};

}  // namespace pliant
