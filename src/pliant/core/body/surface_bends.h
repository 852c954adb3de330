#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/body/embedded_points.h"

namespace pliant {

/// How the round surface of a body bends about points of it, so that contact can follow it between
/// them: points alone roll as a polyhedron does. Four particles carry all of the body, so that
/// their map holds everywhere.
class SurfaceBends {
 public:
  SurfaceBends() = default;
  /// Of n points of a surface at rest that `carried` says how four particles carry, which rest at
  /// `rest`, and outward unit `normals` there, 3 x n.
  SurfaceBends(const Eigen::Matrix3Xd& normals, const EmbeddedPoints& carried,
               const Positions& rest);

  /// Distance of the point nearest to a point [m]; 0: the surface does not bend there as far as is
  /// known.
  double spacing(int point) const {
    const Bend& bend = bends_[static_cast<std::size_t>(point)];
    return bend.reach > 0.0 ? bend.nearest : 0.0;
  }
  bool is_empty() const { return bends_.empty(); }
  /// How far the surface may reach beyond its points between them [m].
  double most_rise() const { return most_rise_; }
  /// Of particles at `x`, the weights of the place of the surface near a point that reaches
  /// farthest against `direction`; its own where the surface does not bend outwards there.
  Eigen::Vector4d farthest(int point, const EmbeddedPoints& carried, const Positions& x,
                           const Eigen::Vector3d& direction) const;
  /// What of a displacement `u` [m], tangential to what the surface touches near a point with the
  /// unit `normal`, is along directions in which it bends, and rolls; none where its normal is not
  /// against that.
  Eigen::Vector3d along_bends(int point, const EmbeddedPoints& carried, const Positions& x,
                              const Eigen::Vector3d& normal, const Eigen::Vector3d& u) const;

 private:
  struct Bend {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();  ///< outward, of the tangent plane [1/m]
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();    ///< of that where it is not flat [m]
    double nearest = 0.0;                                 ///< distance of the nearest point [m]
    double reach = 0.0;  ///< how far it is known [m]; 0: nothing is
  };
  struct Neighbor {
    Eigen::Vector3d offset, turn;  ///< of the point and its normal, from here
  };

  /// The derivative of where the body's map takes places at rest.
  Eigen::Matrix3d map_of(int point, const EmbeddedPoints& carried, const Positions& x) const {
    return x(Eigen::all, carried.particles().col(point)) * gradient_;
  }
  static Bend bend_of(const Eigen::Vector3d& normal, const std::vector<Neighbor>& neighbors,
                      double nearest);

  std::vector<Bend> bends_;
  Eigen::Matrix<double, 4, 3> gradient_ = Eigen::Matrix<double, 4, 3>::Zero();  // of weights
  double most_rise_ = 0.0;
};

}  // namespace pliant
