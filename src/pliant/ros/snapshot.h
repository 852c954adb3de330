#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <pliant/LinkWrenches.h>
#include <pliant/SolverStatus.h>
#include <std_msgs/Header.h>

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "pliant/core/world.h"

namespace pliant {

/// What the simulation thread copies out of a world for the publisher thread. Reused, so that a
/// copy allocates nothing but point fields.
struct Snapshot {
  /// Which messages to make of it; combined by |.
  enum Content : unsigned {
    kSurface = 1u << 0,
    kPoints = 1u << 1,
    kMarkers = 1u << 2,
    kWrenches = 1u << 3,
    kStatus = 1u << 4,
    kDiagnostics = 1u << 5,
  };
  struct AppliedForceMark {
    Eigen::Vector3d point;  ///< mass centre of the vertices it acts on [m]
    Eigen::Vector3d force;  ///< [N]
  };

  unsigned contents = 0;
  std_msgs::Header header;

  // All bodies' particles, one body after the other.
  Eigen::Matrix3Xd x;  ///< [m]
  Eigen::Matrix3Xd v;  ///< [m/s]
  std::map<std::string, Eigen::VectorXd> fields;

  // All bodies' surfaces, one body after the other.
  Eigen::Matrix3Xd surface;         ///< [m]
  Eigen::VectorXd surface_wetness;  ///< 0 to 1; empty where no body can be wet
  bool surface_changes = false;     ///< some body's does: then what follows is set
  Eigen::Matrix3Xi surface_triangles;
  Eigen::Matrix3Xf surface_colors;   ///< rgb of its vertices in [0, 1]
  Eigen::Matrix3Xf particle_colors;  ///< likewise, of all particles

  std::vector<Eigen::Isometry3d> obstacle_poses;  ///< world from shape
  std::vector<AppliedForceMark> forces;
  std::vector<Eigen::Vector3d> fixed;     ///< fixed vertices [m]
  std::vector<Eigen::Vector3d> held;      ///< attached vertices [m]
  std::vector<Eigen::Vector3d> contacts;  ///< vertices whose contact carries force [m]

  SolverStatus status;
  LinkWrenches wrenches;
  diagnostic_msgs::DiagnosticStatus diagnostics;

  /// Copies what `contents` asks for of the world's state; `can_be_wet`: whether some body has the
  /// field `wetness`.
  void take(World& world, bool can_be_wet);
};

}  // namespace pliant
