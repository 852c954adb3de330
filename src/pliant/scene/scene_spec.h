#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/parameters.h"
#include "pliant/core/step/finite_check.h"
#include "pliant/core/system/body_pairs.h"
#include "pliant/geometry/mesh/grid.h"
#include "pliant/scene/robot/robot.h"
#include "pliant/scene/yaml/source_place.h"

namespace pliant {

constexpr long long kMaxVertices = 10'000'000;  ///< of all bodies of a scene together

/// A solver, an effect or a material as a scene names it. Checked against its registry.
struct NamedParameters {
  std::string name;
  ParameterText parameters;
  std::string where;  ///< "FILE:LINE: effects.contact", the beginning of messages about it
  /// Of an effect: those that it acts on; empty: all that it is made for.
  std::vector<std::string> bodies = {};

  bool acts_on(const std::string& body) const {
    return bodies.empty() || std::find(bodies.begin(), bodies.end(), body) != bodies.end();
  }
};

/// Rest shape of a body, one of geometry_kinds().
struct GeometrySpec {
  std::string kind;
  std::optional<GridOptions> grid;  ///< of the kind `grid`
  std::string path;                 ///< absolute; empty for a kind that is not read from a file
  Parameters size, options;         ///< of the kind
  SourcePlace place;
};

/// Some vertices of a body.
struct RegionSpec {
  enum class Kind { kCorner, kVertices, kBox, kSphere };
  Kind kind = Kind::kVertices;
  bool corner_right = false;                         ///< kCorner of a grid: at its greatest x
  bool corner_top = false;                           ///< kCorner of a grid: at its greatest y
  std::vector<int> vertices;                         ///< kVertices: indices
  Eigen::AlignedBox3d box;                           ///< kBox: in the world [m]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< kSphere: in the world [m]
  double radius = 0.0;                               ///< kSphere [m]
  SourcePlace place;
};

/// Vertices that springs hold to the world, an obstacle or a robot link.
struct AttachmentSpec {
  std::string name;
  RegionSpec region;
  std::string to;
  double stiffness = 0.0;       ///< of all together [N/m]
  double from = 0.0;            ///< [s]
  std::optional<double> until;  ///< [s]
  SourcePlace place;
};

struct BodySpec {
  std::string name;
  NamedParameters model;  ///< name and material
  GeometrySpec geometry;
  Eigen::Isometry3d world_from_body = Eigen::Isometry3d::Identity();  ///< [m]
  std::vector<RegionSpec> fixed;  ///< vertices that stay where they are
  std::vector<AttachmentSpec> attachments;
  std::optional<NamedParameters> solver;               ///< its own; else the scene's
  std::optional<NamedParameters> time_integration;     ///< likewise
  std::optional<Eigen::Vector3f> color;                ///< rgb in [0, 1]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< at the start [m/s]
  SourcePlace place;
};

/// What an effect between bodies does with two of them.
struct BodyPairSpec {
  std::string one, other;
  BodyPairs::Numbers numbers;  ///< of their own
  SourcePlace place;
};

/// Whom an effect between bodies acts on.
struct BodyPairsSpec {
  std::vector<BodyPairSpec> touching, left_out;
  bool only_named = false;  ///< none touch but those in `touching`
};

struct ObstacleSpec {
  std::string name;
  std::string shape;                               ///< plane, sphere, box, capsule, cylinder, mesh
  double radius = 0.0;                             ///< sphere, capsule, cylinder [m]
  double length = 0.0;                             ///< capsule (its cylinder part), cylinder [m]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< box: full extents [m]
  std::string mesh_path;                           ///< absolute; mesh only
  double scale = 1.0;                              ///< of the mesh
  double voxel_size = 0.0;                      ///< of the mesh's distance samples [m]; 0 chooses
  ColliderKind collider = ColliderKind::kAuto;  ///< of the mesh
  double thickness = 0.0;                       ///< of the mesh's thick shell [m]; 0 chooses
  Eigen::Isometry3d world_from_shape = Eigen::Isometry3d::Identity();  ///< [m]
  std::optional<double> friction;                                      ///< Coulomb coefficient
  std::optional<double> temperature;                                   ///< [K]
  bool liquid = false;                   ///< wets cloth, stops nothing
  std::optional<Eigen::Vector4f> color;  ///< rgba in [0, 1]
  SourcePlace place;
};

struct RobotSpec {
  std::string field = "robot";  ///< of the scene: "robot", or "robot[1]" of several
  std::string urdf_path;        ///< absolute; "" when the scene leaves it to `robot_description`
  std::string keyframes_path;   ///< absolute; "" without
  SourcePlace keyframes_place;
  std::string prefix;      ///< before the names of its links and joints
  std::string base_frame;  ///< tf frame that the base follows in a node; "" without
  SourcePlace base_frame_place;
  LinkChoice touching;         ///< `links`: those that bodies touch
  bool visual_shapes = false;  ///< a link without a collision shape takes its visual ones
  JointLimitRule limit_rule = JointLimitRule::kRefuse;
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();  ///< or base_frame from it [m]
  struct NamedValue {
    double value = 0.0;
    SourcePlace place;
  };
  std::map<std::string, NamedValue> initial;            ///< by joint [m] or [rad]
  bool limit_efforts = false;                           ///< joints have the efforts of the URDF
  std::map<std::string, NamedValue> efforts;            ///< by joint, instead [N] or [N m]
  std::optional<double> friction;                       ///< Coulomb coefficient of every link
  std::map<std::string, NamedValue> link_friction;      ///< by link, instead
  std::optional<double> temperature;                    ///< of every link [K]
  std::map<std::string, NamedValue> link_temperatures;  ///< by link, instead [K]
  LinkColliders colliders;                              ///< of collision meshes
  SourcePlace place;
};

enum class FrameFormat { kPly, kObj };

struct RecordingSpec {
  int every = 0;  ///< a surface frame each so many steps; 0 none
  FrameFormat format = FrameFormat::kPly;
  bool frames_alone = false;   ///< no rows of the steps between frames
  bool surface_alone = false;  ///< frames without fields, rows without energies
};

/// What a scene file says, checked: names are known, parameters in range, paths resolved (files
/// other than scenes are not opened yet).
struct SceneSpec {
  std::string path;  ///< of the file that was read
  std::string name;  ///< the file's stem unless it gives one
  std::string description;
  double time_step = 0.0;  ///< [s]
  std::optional<int> threads;
  std::vector<BodySpec> bodies;
  std::vector<ObstacleSpec> obstacles;
  std::vector<RobotSpec> robots;
  std::vector<NamedParameters> effects;  ///< in the registry's order
  BodyPairsSpec body_pairs;              ///< of the effect body_contact
  NamedParameters solver;                ///< of bodies that name none and that it works for
  bool names_solver = true;  ///< false: `solver` is the default of the first body's model
  std::optional<NamedParameters> time_integration;  ///< of bodies that name none and can have it
  std::optional<std::string> backend;               ///< of all solvers, instead of their own
  std::optional<RecordingSpec> recording;
  FiniteCheck limits;
};

}  // namespace pliant
