#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "pliant/core/obstacle.h"
#include "pliant/effects/contact/contact_points.h"

namespace pliant {

/// A point of a body near an obstacle: it must stay where normal . x >= plane.
struct Contact {
  int point = 0;
  int obstacle = 0;
  Eigen::Vector3d normal;          ///< away from the obstacle, world axes
  double plane = 0.0;              ///< [m]
  Eigen::Vector3d surface_motion;  ///< of the touched surface over the step [m]
  Eigen::Vector3d touched;         ///< place of the surface at the step's end [m]
  bool is_of_face = false;         ///< it keeps that from a flat face, in which its point lies
  double normal_force = 0.0;       ///< multiplier [N], >= -adhesion
  double adhesion = 0.0;           ///< that water holds it with at the most [N]
  double friction_factor = 1.0;    ///< factor of water on friction
  double begun = 0.0;              ///< normal force that a solver began the step with [N]
  double guess = 0.0;              ///< of the normal force, for points that share particles [N]
  int corrections = 0;             ///< of a solver that moves all particles, which held it so far
  /// Direction in which the last of these corrections let it slide, zero where it stuck.
  Eigen::Vector3d slide = Eigen::Vector3d::Zero();
  Eigen::Vector3d friction_force = Eigen::Vector3d::Zero();  ///< multiplier [N], tangential
  Eigen::Vector3d friction_guess = Eigen::Vector3d::Zero();  ///< as `guess` [N]
  /// By how much its point came off where it stuck, which friction takes back [m].
  Eigen::Vector3d owed = Eigen::Vector3d::Zero();

  /// Whether it carries force and does not let go.
  bool is_held() const { return normal_force > -adhesion; }
};

/// Finds contacts of a body's points that move with its particles from x_start to x in a step with
/// obstacles that move from pose_start to pose_end, continuously: nothing tunnels, however thin or
/// fast.
class ContactDetection {
 public:
  // Share of the offset that a point may move in a step without a swept test: it then still ends on
  // its own side of the surface.
  static constexpr double kSafeShare = 0.5;
  // Share of the offset by which a tangent plane may lie behind the surface where a point is
  // predicted to end, as it does in a groove or between the walls of a corner.
  static constexpr double kUncovered = 0.1;

  /// Points are kept `offset` away from surfaces; contacts open by less than `margin` are found
  /// too [m]. Obstacles outlive this.
  ContactDetection(const std::vector<Obstacle>& obstacles, double offset, double margin,
                   ContactPoints points = ContactPoints(nullptr));

  /// Appends the contacts of the step to `contacts`, obstacle by obstacle, point by point. Points
  /// that particles carry, and that end near a surface, are kept from its tangent plane where they
  /// would be if no force changed their velocities. So are points of all kinds that begin near a
  /// surface and would stay near it then, though the step predicts them away from it: something may
  /// press them against it.
  void find(const Particles& particles, double dt, std::vector<Contact>& contacts);
  /// As find(), in the same step: x may have moved since, x_start has not.
  void find_again(const Particles& particles, double dt, std::vector<Contact>& contacts);
  /// How deep points that begin the next steps too deep may still be at their end [m].
  void allow_depth(double depth) { allowed_depth_ = depth; }
  /// By how much the point of the deepest of these contacts of the step began too deep [m].
  double deepest_start(const Particles& particles, const std::vector<Contact>& contacts) const;
  double offset() const { return offset_; }
  double margin() const { return margin_; }
  void widen_margin(double margin) { margin_ = std::max(margin_, margin); }

 private:
  struct Query;  // one obstacle as the loop over points needs it
  struct Motion {
    const Positions& start;
    const Positions& end;
    Eigen::AlignedBox3d box;  // of both [m]
    double largest = 0.0;     // displacement of a point [m]
  };
  Motion motion_of(const Particles& particles);
  void find(const Particles& particles, double dt, bool is_prediction,
            std::vector<Contact>& contacts);
  void find_with(int obstacle, const Particles& particles, const Motion& motion, double reach,
                 double dt, bool is_prediction, std::vector<Contact>& contacts);

  const std::vector<Obstacle>& obstacles_;
  double offset_;
  double margin_;
  double allowed_depth_ = 0.0;  // [m]
  ContactPoints points_;
  Positions embedded_start_, embedded_end_;  // of points that particles carry
  // Per obstacle and point: a place in the obstacle's frame and the radius of a ball about it that
  // holds no contact. While the point stays in its ball, no distance is computed.
  std::vector<std::vector<Eigen::Vector4f>> clear_balls_;
  std::vector<std::vector<Contact>> found_;  // of each part of the points, of one obstacle
};

}  // namespace pliant
