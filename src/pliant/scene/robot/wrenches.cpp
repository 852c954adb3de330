#include "pliant/scene/robot/wrenches.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/scene/yaml/table_cell.h"

namespace pliant {

Eigen::Isometry3d own_frame(const Obstacle& obstacle) {
  return obstacle.pose_end * obstacle.link_from_shape.inverse();
}

WrenchAverage::WrenchAverage(const std::vector<Obstacle>& obstacles) : slots_(obstacles.size()) {
  for (const bool links : {true, false}) {
    for (std::size_t o = 0; o < obstacles.size(); ++o) {
      const bool is_link = !obstacles[o].link.empty();
      if (is_link != links) continue;
      const auto same = [&](const Wrench& known) {
        return is_link && known.name == obstacles[o].link;
      };
      const auto found = std::find_if(means_.begin(), means_.end(), same);
      slots_[o] = found != means_.end()
                      ? static_cast<std::size_t>(found - means_.begin())
                      : add_slot(is_link ? obstacles[o].link : obstacles[o].name, is_link);
    }
  }
  sums_.resize(means_.size());
}

std::size_t WrenchAverage::add_slot(const std::string& name, bool is_robot_link) {
  const auto is_taken = [this](const std::string& text) {
    return std::any_of(means_.begin(), means_.end(),
                       [&](const Wrench& known) { return known.name == text; });
  };
  Wrench wrench;
  wrench.name = name;
  for (int n = 2; is_taken(wrench.name); ++n) wrench.name = fmt::format("{}_{}", name, n);
  wrench.is_robot_link = is_robot_link;
  means_.push_back(wrench);
  return means_.size() - 1;
}

void WrenchAverage::add(const std::vector<Obstacle>& obstacles,
                        const std::vector<Reaction>& reactions) {
  ++steps_;
  for (std::size_t o = 0; o < reactions.size(); ++o) {
    const Eigen::Isometry3d frame = own_frame(obstacles[o]);
    const Eigen::Vector3d arm = obstacles[o].pose_end.translation() - frame.translation();
    const Eigen::Vector3d torque = reactions[o].torque + arm.cross(reactions[o].force);
    Sum& sum = sums_[slots_[o]];
    sum.force += frame.linear().transpose() * reactions[o].force;
    sum.torque += frame.linear().transpose() * torque;
  }
}

const std::vector<Wrench>& WrenchAverage::take() {
  if (steps_ == 0) return means_;
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    means_[s].force = sums_[s].force / steps_;
    means_[s].torque = sums_[s].torque / steps_;
    sums_[s] = Sum();
  }
  steps_ = 0;
  return means_;
}

void WrenchAverage::clear() {
  steps_ = 0;
  for (Sum& sum : sums_) sum = Sum();
  for (Wrench& mean : means_) mean.force = mean.torque = Eigen::Vector3d::Zero();
}

std::vector<Wrench> zero_wrenches(const std::vector<Obstacle>& obstacles) {
  return WrenchAverage(obstacles).means();
}

std::string wrench_columns(const std::vector<Wrench>& wrenches) {
  std::string text;
  for (const Wrench& wrench : wrenches) {
    for (const char* part : {"force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z"}) {
      text += "," + table_cell(wrench.name + "." + part);
    }
  }
  return text;
}

std::string wrench_cells(const std::vector<Wrench>& wrenches) {
  std::string text;
  for (const Wrench& wrench : wrenches) {
    for (const Eigen::Vector3d& part : {wrench.force, wrench.torque}) {
      fmt::format_to(std::back_inserter(text), ",{},{},{}", part.x(), part.y(), part.z());
    }
  }
  return text;
}

}  // namespace pliant
