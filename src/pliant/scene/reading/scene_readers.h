#pragma once

// The parts of a scene file, one function each; read_scene() calls them. All throw InputError
// "FILE:LINE: ...".

#include <string>
#include <vector>

#include "pliant/scene/robot/packages.h"
#include "pliant/scene/scene_spec.h"
#include "pliant/scene/yaml/yaml_map.h"
#include "pliant/scene/yaml/yaml_tree.h"

namespace pliant {

std::vector<BodySpec> read_bodies(const YamlNode& list, const FiniteCheck& limits,
                                  const PackageResolver& resolver);
/// Rest shape of a body of that model.
GeometrySpec read_geometry(const YamlNode& node, const std::string& field, const std::string& model,
                           const PackageResolver& resolver);
/// The keys that say which vertices are meant; a map has one of them.
const std::vector<std::string>& region_keys();
/// Of a map that has one of region_keys(); `is_grid`: of a body that is a grid.
RegionSpec read_region(const YamlMap& map, bool is_grid);
std::vector<AttachmentSpec> read_attachments(const YamlNode& list, const std::string& field,
                                             bool is_grid);
std::vector<ObstacleSpec> read_obstacles(const YamlNode& list, const FiniteCheck& limits,
                                         const PackageResolver& resolver);
/// Of a map, or a list of maps, one a robot.
std::vector<RobotSpec> read_robots(const YamlNode& node, const FiniteCheck& limits,
                                   const PackageResolver& resolver);
/// Of the keys `effects` and `gravity` of a scene, into its spec, which has bodies and obstacles.
void read_effects(const YamlMap& scene, SceneSpec& spec);
/// The keys of an effect between bodies that say which of them it acts on.
const std::vector<std::string>& body_pair_keys();
struct SceneNames {
  std::vector<std::string> bodies, obstacles;
};
/// What these keys say in the map (or nothing) `effect`; `parameters` are those of a pair.
BodyPairsSpec read_body_pairs(const YamlNode& effect, const std::string& field,
                              const SceneNames& names,
                              const std::vector<ParameterSpec>& parameters);
NamedParameters read_solver(const YamlNode& node, const std::string& field);
/// A time integration, by its name alone.
NamedParameters read_time_integration(const YamlNode& node, const std::string& field);

/// `position` [m] and `rotation_rpy` [rad], and the pose they make: Rz(yaw) Ry(pitch) Rx(roll).
std::vector<ParameterSpec> pose_parameters(const FiniteCheck& limits);
Eigen::Isometry3d read_pose(const YamlMap& map);
ParameterSpec friction_parameter();
ParameterSpec temperature_parameter();
/// `scale` of a mesh.
ParameterSpec scale_parameter();

/// 3 or `most` numbers in [0, 1]; alpha is 1 unless given.
Eigen::Vector4f read_color(const YamlNode& node, const std::string& field, int most);
/// The absolute path that a text means.
std::string read_path(const YamlNode& node, const std::string& field,
                      const PackageResolver& resolver);
/// Name of the item of a list; refuses one that is in `taken`, and adds it there.
std::string read_unique_name(const YamlMap& map, std::vector<std::string>& taken);

std::vector<ParameterSpec> joined(std::vector<ParameterSpec> first,
                                  const std::vector<ParameterSpec>& second);

}  // namespace pliant
