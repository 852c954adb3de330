#include "pliant/ros/wrench_average.h"

#include <algorithm>

#include "pliant/ros/conversions.h"

namespace pliant {

WrenchAverage::WrenchAverage(const std::vector<Obstacle>& obstacles) : slots_(obstacles.size()) {
  const auto slot_of = [this](const std::string& name, bool is_link) {
    const auto same = [&](const LinkWrench& entry) {
      return is_link && entry.is_robot_link && entry.name == name;
    };
    const auto found = std::find_if(means_.begin(), means_.end(), same);
    if (found != means_.end()) return static_cast<std::size_t>(found - means_.begin());
    LinkWrench entry;
    entry.name = name;
    entry.is_robot_link = is_link;
    means_.push_back(entry);
    return means_.size() - 1;
  };
  for (const bool links : {true, false}) {
    for (std::size_t o = 0; o < obstacles.size(); ++o) {
      const bool is_link = !obstacles[o].link.empty();
      if (is_link == links)
        slots_[o] = slot_of(is_link ? obstacles[o].link : obstacles[o].name, links);
    }
  }
  sums_.resize(means_.size());
}

void WrenchAverage::add(const std::vector<Obstacle>& obstacles,
                        const std::vector<Reaction>& reactions) {
  ++steps_;
  for (std::size_t o = 0; o < reactions.size(); ++o) {
    const Obstacle& obstacle = obstacles[o];
    const Eigen::Isometry3d frame = obstacle.pose_end * obstacle.link_from_shape.inverse();
    const Eigen::Vector3d arm = obstacle.pose_end.translation() - frame.translation();
    const Eigen::Vector3d torque = reactions[o].torque + arm.cross(reactions[o].force);
    Sum& sum = sums_[slots_[o]];
    sum.force += frame.linear().transpose() * reactions[o].force;
    sum.torque += frame.linear().transpose() * torque;
  }
}

const std::vector<LinkWrench>& WrenchAverage::take() {
  if (steps_ == 0) return means_;
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    means_[s].wrench.force = to_vector3(sums_[s].force / steps_);
    means_[s].wrench.torque = to_vector3(sums_[s].torque / steps_);
    sums_[s] = Sum();
  }
  steps_ = 0;
  return means_;
}

void WrenchAverage::clear() {
  steps_ = 0;
  for (Sum& sum : sums_) sum = Sum();
  for (LinkWrench& mean : means_) mean.wrench = geometry_msgs::Wrench();
}

}  // namespace pliant
