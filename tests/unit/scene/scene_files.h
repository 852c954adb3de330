#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace pliant {

/// A folder of files that vanishes with this object.
class SceneFiles {
 public:
  SceneFiles() {
    std::string pattern = (std::filesystem::temp_directory_path() / "pliant_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~SceneFiles() { std::filesystem::remove_all(folder_); }
  SceneFiles(const SceneFiles&) = delete;
  SceneFiles& operator=(const SceneFiles&) = delete;

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }

 private:
  std::string folder_;
};

/// One link that a prismatic joint lifts along z, with a box.
constexpr const char* kLiftUrdf = R"(<robot name="lift">
  <link name="base"/>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="hand"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <link name="hand">
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
  </link>
</robot>
)";

constexpr const char* kLiftMotion = R"(joints: [lift]
keyframes:
  - {time: 0, positions: [0]}
  - {time: 1, positions: [0.5]}
)";

/// A scene with every key; tests refer to its line numbers.
constexpr const char* kFullScene = R"(name: test
time_step: 0.005
threads: 1
bodies:
  - name: towel
    model: cloth
    geometry: {grid: {size: [1, 2], vertices: [4, 5]}}
    position: [0, 0, 1]
    rotation_rpy: [0, 0, 0]
    velocity: [0, 0, 0]
    color: [0.1, 0.2, 0.3]
    material: {areal_density: 0.2, stretch_warp: 100}
    fixed: [{corner: lower_left}]
obstacles:
  - {name: ground, shape: plane, friction: 0.3}
  - {name: ball, shape: sphere, radius: 0.1}
robot:
  urdf: robot.urdf
  keyframes: motion.yaml
  position: [0, 0, 2]
  initial: {lift: 0.1}
effects:
  gravity: {acceleration: [0, 0, -9.81]}
  contact: {thickness: 0.002}
  friction: {coefficient: 0.4}
solver: {name: xpbd, iterations: 5}
recording: {every: 10, format: ply}
limits: {max_speed: 1000, max_distance: 100}
description: every key
)";

/// Writes a scene with the files that kFullScene names beside it.
inline std::string write_scene(const SceneFiles& files, const std::string& text) {
  files.write("robot.urdf", kLiftUrdf);
  files.write("motion.yaml", kLiftMotion);
  return files.write("scene.yaml", text);
}

/// `text` with the first `from` replaced; throws when there is none.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto found = text.find(from);
  if (found == std::string::npos) throw std::logic_error("'" + from + "' is not in the text");
  return text.replace(found, from.size(), to);
}

}  // namespace pliant
