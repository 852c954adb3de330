#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/scene/robot/motion/robot_driver.h"
#include "pliant/scene/scene_spec.h"
#include "pliant/scene/yaml/scene_value.h"

namespace pliant {

/// Reads and checks a scene file with `values` in place of its own. `resolver` finds package://
/// folders; null: find_package(). `text`, unless it is null, stands for what is in the file. Throws
/// InputError "FILE:LINE: ..." for whatever is wrong in it.
SceneSpec read_scene(const std::string& path, const PackageResolver& resolver = nullptr,
                     const std::vector<SceneValue>& values = {}, const std::string* text = nullptr);

/// What a caller asks for instead of what the scene says.
struct SceneOverrides {
  /// What the scene file holds, which then need not be there.
  std::optional<std::string> text;
  /// Instead of what stands at their paths in the file.
  std::vector<SceneValue> values;
  /// Another solver. Parameters of the scene's solver are kept only when the name is the same.
  std::optional<std::string> solver;
  ParameterText solver_parameters;  ///< replace those of the same name
  /// `backend` of all solvers, the bodies' own too. "cuda" is refused for one that has no other
  /// than the CPU.
  std::optional<std::string> backend;
  std::optional<std::string> time_integration;  ///< of all bodies, their own too
  std::optional<double> time_step;              ///< [s]
  std::optional<int> threads;
  std::optional<int> usual_threads;  ///< where neither that nor the scene names a number
  bool keeps_threads = false;        ///< the number of threads stays, whoever names another one
  /// URDF text instead of `urdf` of the scene's only robot; of several, of those without `urdf`.
  std::optional<std::string> robot_description;
  /// Otherwise robots keep their initial positions until the caller adds a RobotDriver.
  bool drive_robot_from_keyframes = true;
  /// Whether the caller moves bases and free joints by tf and adds the drivers of all robots.
  bool knows_tf = false;
  /// Finds `package://` folders of the scene and the robot; find_package() without.
  PackageResolver package_resolver;
};

struct SceneRobot {
  std::shared_ptr<Robot> robot;
  std::shared_ptr<JointSource> keyframes;  ///< null without
  const RobotDriver* driver = nullptr;     ///< of the world; null while nothing moves the robot
  std::vector<std::string> warnings;       ///< of its keyframes

  /// World from `link`, where the last step left it. Throws InputError for an unknown link.
  Eigen::Isometry3d link_pose(const std::string& link) const;
};

struct LoadedScene {
  SceneSpec spec;  ///< with the overrides applied
  std::unique_ptr<World> world;
  std::vector<SceneRobot> robots;     ///< in the order of the spec's
  std::vector<std::string> warnings;  ///< what is legal but surely not meant
  std::vector<std::string> notes;     ///< a line for each mesh that was taken for a solid: as what
  int mended_meshes = 0;              ///< of these, such as are not used as they are in the file
};

/// Puts `overrides` into `spec`. Throws InputError for a bad override.
void apply_overrides(const SceneOverrides& overrides, SceneSpec& spec);

/// Opens the meshes and the robot that `spec` names and makes the world. Throws InputError; its
/// message begins with the file and line of the entry.
std::unique_ptr<World> build_world(const SceneSpec& spec);

/// read_scene(), apply_overrides() and build_world() in one. Sets the number of threads
/// (parallel.h) when the scene or the overrides name one. Throws InputError.
LoadedScene load_scene(const std::string& path, const SceneOverrides& overrides = {});

}  // namespace pliant
