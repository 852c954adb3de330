#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "pliant/core/body/embedded_points.h"
#include "pliant/core/group.h"
#include "pliant/effects/body_contact/body_pair_table.h"

namespace pliant {

/// The surfaces of a group's bodies side by side: vertices that the group's particles carry, and
/// triangles between them. Bodies of loose particles have vertices alone, balls of their spacing.
class BodySurfaces {
 public:
  struct Entry {
    int particle;  ///< of the group
    double weight;
  };

  /// Of the group's bodies as they are now.
  explicit BodySurfaces(const Group& group);

  int size() const { return static_cast<int>(body_.size()); }  ///< number of vertices
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  /// Of each vertex, the number of its body in the group.
  const std::vector<int>& bodies() const { return body_; }
  /// The number of a body's first vertex, and of its vertices.
  int first(int body) const { return body == 0 ? 0 : ends_[index(body - 1)]; }
  int count(int body) const { return ends_[index(body)] - first(body); }
  bool is_solid(int body) const { return is_solid_[index(body)]; }  ///< as Model::is_solid()
  bool is_rigid(int body) const { return is_rigid_[index(body)]; }  ///< as Model::is_rigid()
  bool has_rigid() const {
    return std::find(is_rigid_.begin(), is_rigid_.end(), true) != is_rigid_.end();
  }
  /// Displacements of the group's particles become 0 but for those of rigid bodies.
  void leave_rigid(Positions& by) const;
  /// Of each vertex that is a ball; else 0 [m].
  const std::vector<double>& radius() const { return radius_; }

  const Entry* begin(int vertex) const { return entries_.data() + begins_[index(vertex)]; }
  const Entry* end(int vertex) const { return entries_.data() + begins_[index(vertex) + 1]; }
  /// Of all vertices, for positions `x` of the group's particles [m].
  void positions(const Positions& x, Positions& vertices) const;
  /// Whether no two bodies that touch come nearer than `reach` [m] on the straight paths of their
  /// vertices, by the boxes around them.
  bool are_far_apart(const Positions& start, const Positions& end, double reach,
                     const BodyPairTable& pairs) const;

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  void add_embedded(const EmbeddedPoints& points, int first);
  void end_body(int number, const Eigen::Matrix3Xi& triangles);

  std::vector<Entry> entries_;
  std::vector<std::size_t> begins_ = {0};
  std::vector<int> body_;
  std::vector<double> radius_;
  std::vector<int> ends_;  // vertices of the bodies
  std::vector<bool> is_solid_, is_rigid_;
  std::vector<int> particles_;  // the first of each body
  Eigen::Matrix3Xi triangles_;
};

}  // namespace pliant
