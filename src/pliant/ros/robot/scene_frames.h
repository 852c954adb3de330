#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "pliant/effects/attachment.h"
#include "pliant/ros/robot/placed_frame.h"
#include "pliant/ros/running/simulation.h"
#include "pliant/scene/robot/wrenches.h"

namespace pliant {

/// The tf frames that a node says: NODE/OBSTACLE of each of the scene's obstacles,
/// NODE/attachments/ NAME of what is held, and the links of a robot under their own names, as a
/// robot_state_publisher calls them.
class SceneFrames {
 public:
  /// `node`: its name. `say_robot`: its links are said too.
  SceneFrames(const Simulation& simulation, const std::string& node, bool say_robot);

  /// The frame that the wrench on a link or an obstacle is in.
  const std::string& frame_of(const Wrench& wrench) const;
  /// Of obstacles, where they stand at the beginning.
  const std::vector<PlacedFrame>& standing() const { return standing_; }
  /// Replaces `frames` by those of links, of attachments, and of obstacles that have moved.
  void list_moving(const Simulation& simulation, std::vector<PlacedFrame>& frames);

 private:
  std::string node_;
  bool say_robot_;
  std::vector<std::string> wrench_names_, wrench_frames_;
  std::vector<PlacedFrame> standing_;
  std::vector<std::size_t> obstacles_;  // of the world: those of standing_
  std::vector<bool> has_moved_;
  std::vector<AttachmentEffect::Anchor> anchors_;
};

}  // namespace pliant
