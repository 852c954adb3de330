#include "pliant/ros/robot/scene_frames.h"

#include <algorithm>

namespace pliant {

SceneFrames::SceneFrames(const Simulation& simulation, const std::string& node, bool say_robot)
    : node_(node.substr(node.find_first_not_of('/')) + "/"), say_robot_(say_robot) {
  const std::vector<Obstacle>& obstacles = simulation.world().obstacles();
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (obstacles[o].link.empty()) obstacles_.push_back(o);
  }
  std::vector<std::string> names;
  for (const std::size_t o : obstacles_) names.push_back(obstacles[o].name);
  names = graph_names_of(names, "obstacle_");
  for (std::size_t k = 0; k < names.size(); ++k) {
    standing_.push_back({node_ + names[k], obstacles[obstacles_[k]].pose_end});
  }
  has_moved_.assign(names.size(), false);
  // The wrenches' own order: links, then the scene's obstacles.
  std::size_t next = 0;
  for (const Wrench& wrench : zero_wrenches(obstacles)) {
    wrench_names_.push_back(wrench.name);
    wrench_frames_.push_back(wrench.is_robot_link ? wrench.name : standing_[next++].name);
  }
}

const std::string& SceneFrames::frame_of(const Wrench& wrench) const {
  const auto found = std::find(wrench_names_.begin(), wrench_names_.end(), wrench.name);
  return wrench_frames_.at(static_cast<std::size_t>(found - wrench_names_.begin()));
}

void SceneFrames::list_moving(const Simulation& simulation, std::vector<PlacedFrame>& frames) {
  frames.clear();
  const World& world = simulation.world();
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const Eigen::Isometry3d& pose = world.obstacles()[obstacles_[k]].pose_end;
    has_moved_[k] = has_moved_[k] || pose.matrix() != standing_[k].pose.matrix();
    if (has_moved_[k]) frames.push_back({standing_[k].name, pose});
  }
  if (say_robot_) simulation.list_links(frames);
  anchors_.clear();
  for (const Body& body : world.bodies()) {
    const auto* effect = find_attachments(body);
    if (effect != nullptr) effect->add_anchors(anchors_);
  }
  std::vector<std::string> names;
  for (const auto& anchor : anchors_) names.push_back(anchor.name);
  names = graph_names_of(names, "attachment_");
  for (std::size_t k = 0; k < names.size(); ++k) {
    frames.push_back({node_ + "attachments/" + names[k], anchors_[k].pose});
  }
}

}  // namespace pliant
