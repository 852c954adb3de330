#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <pliant/SolverStatus.h>
#include <std_msgs/Header.h>

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/ros/robot/placed_frame.h"
#include "pliant/scene/contact_list.h"
#include "pliant/scene/robot/wrenches.h"

namespace pliant {

/// Whether a body's surface can become wet: then its colours follow its field `wetness`.
bool can_be_wet(const Body& body);

/// Of one body, what the simulation thread copies for the publisher thread.
struct BodySnapshot {
  bool is_wettable = false;  ///< can_be_wet()
  std::string color_field;  ///< that colours show (field_to_color()); empty: the body's own colours
  unsigned contents = 0;    ///< of Snapshot::Content, those of a body

  Eigen::Matrix3Xd surface;         ///< [m]
  Eigen::VectorXd surface_wetness;  ///< 0 to 1; empty where it cannot be wet
  Eigen::VectorXd surface_values;   ///< of `color_field`
  bool surface_changes = false;     ///< then what follows is set
  Eigen::Matrix3Xi surface_triangles;
  Eigen::Matrix3Xf surface_colors;  ///< rgb of its vertices in [0, 1]; also with `color_field`

  Eigen::Matrix3Xd x;  ///< [m]
  Eigen::Matrix3Xd v;  ///< [m/s]
  std::map<std::string, Eigen::VectorXd> fields;
  Eigen::VectorXd particle_values;   ///< of `color_field`
  Eigen::Matrix3Xf particle_colors;  ///< likewise, of the particles

  /// Whether surface_colors and particle_colors are its colours.
  bool has_colors() const { return surface_changes || !color_field.empty(); }

  void take_surface(const Body& body);
  void take_points(const Body& body);
};

/// What the simulation thread copies out of a world for the publisher thread. Reused, so that a
/// copy allocates nothing but point fields.
struct Snapshot {
  /// Which messages to make of it; combined by |.
  enum Content : unsigned {
    kSurface = 1u << 0,   ///< of a body
    kPoints = 1u << 1,    ///< of a body
    kSurfaces = 1u << 2,  ///< of all bodies
    kMarkers = 1u << 3,
    kWrenches = 1u << 4,
    kStatus = 1u << 5,
    kDiagnostics = 1u << 6,
    kMesh = 1u << 7,  ///< of a body
    kContacts = 1u << 8,
    kFrames = 1u << 9,
    kShadows = 1u << 10,  ///< of bodies and obstacles
  };
  struct AppliedForceMark {
    Eigen::Vector3d point;  ///< mass centre of the vertices it acts on [m]
    Eigen::Vector3d force;  ///< [N]
  };

  /// `color_fields`: of each body, from fields_to_color(); empty: none.
  explicit Snapshot(const World& world, const std::vector<std::string>& color_fields = {});

  unsigned contents = 0;
  double time = 0.0;  ///< simulated [s]
  std_msgs::Header header;
  std::vector<BodySnapshot> bodies;

  std::vector<Eigen::Isometry3d> obstacle_poses;  ///< world from shape
  std::vector<AppliedForceMark> forces;
  std::vector<Eigen::Vector3d> fixed;     ///< fixed vertices [m]
  std::vector<Eigen::Vector3d> held;      ///< attached vertices [m]
  std::vector<Eigen::Vector3d> contacts;  ///< vertices whose contact carries force [m]

  SolverStatus status;
  std::vector<Wrench> wrenches;
  std::vector<TouchedPoint> touched;
  std::uint64_t step = 0;  ///< after which they are so
  std::vector<PlacedFrame> frames;
  std::vector<diagnostic_msgs::DiagnosticStatus> diagnostics;

  /// Nothing is asked for.
  void clear_contents();
  /// Copies what is asked for of the world's state.
  void take(World& world);
};

}  // namespace pliant
