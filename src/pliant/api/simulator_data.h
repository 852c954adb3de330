#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/scene.h"
#include "pliant/simulator.h"

namespace pliant {

/// Joints stand where a program has put them.
class ProgramJoints final : public JointSource {
 public:
  explicit ProgramJoints(std::vector<double> initial) : values(std::move(initial)) {}
  void positions(double /*time*/, std::vector<double>& positions) override { positions = values; }

  std::vector<double> values;
};

struct Simulator::Data {
  explicit Data(LoadedScene loaded);

  LoadedScene scene;
  std::vector<std::shared_ptr<ProgramJoints>> programs;  // of each robot; null: keyframes move it

  World& world() const { return *scene.world; }
  int index_of(const std::string& body) const;
  const Body& body(const std::string& name) const;
  /// Of each robot where a program moves it; what a program has changed, which set_joints() takes.
  std::vector<std::vector<double>> joints() const;
  void set_joints(std::vector<std::vector<double>> joints);
  /// Puts `position` of `joint` into `joints`. Throws InputError.
  void change(const std::string& joint, double position,
              std::vector<std::vector<double>>& joints) const;
  std::vector<std::string> joint_names() const;
  /// The robot that has the joint. Throws InputError.
  std::size_t robot_of(const std::string& joint) const;
};

/// What a program asks for, as the scene's reader takes it; `text`: of the scene, or null.
SceneOverrides overrides_of(const SimulatorOptions& options, const std::string* text);

}  // namespace pliant
