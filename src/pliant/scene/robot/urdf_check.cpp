#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"
#include "pliant/scene/robot/urdf_reader.h"

namespace pliant {
namespace {

bool is_finite(const urdf::Pose& pose) {
  const auto& p = pose.position;
  const auto& q = pose.rotation;
  return std::isfinite(p.x + p.y + p.z) && std::isfinite(q.x + q.y + q.z + q.w);
}

bool is_movable(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
         joint.type == urdf::Joint::PRISMATIC;
}

void check_axis_and_limits(const urdf::Joint& joint, const std::string& where) {
  const Eigen::Vector3d axis(joint.axis.x, joint.axis.y, joint.axis.z);
  if (!axis.allFinite() || axis.norm() < 1e-9) {
    throw InputError(where + " has an axis of no length");
  }
  if (joint.type == urdf::Joint::CONTINUOUS) return;
  if (joint.limits == nullptr) throw InputError(where + " has no limit");
  const double lower = joint.limits->lower;
  const double upper = joint.limits->upper;
  if (!(std::isfinite(lower) && std::isfinite(upper) && lower <= upper)) {
    throw InputError(fmt::format("{} has limits from {} to {}, but lower must be at most upper",
                                 where, lower, upper));
  }
}

std::vector<std::string> movable_joints(const urdf::ModelInterface& model) {
  std::vector<std::string> names;
  for (const auto& [name, joint] : model.joints_) {
    if (is_movable(*joint)) names.push_back(name);
  }
  return names;
}

void check_mimic(const urdf::ModelInterface& model, const urdf::Joint& joint,
                 const std::string& where) {
  const urdf::Joint* at = &joint;
  for (std::size_t i = 0; at->mimic != nullptr; ++i) {
    if (i > model.joints_.size()) throw InputError(where + " mimics itself");
    if (!std::isfinite(at->mimic->multiplier) || !std::isfinite(at->mimic->offset)) {
      throw InputError(where + " mimics with a multiplier or offset that is not finite");
    }
    const auto found = model.joints_.find(at->mimic->joint_name);
    if (found == model.joints_.end() || !is_movable(*found->second)) {
      throw InputError(
          where + " mimics: " +
          unknown_name_message("movable joint", at->mimic->joint_name, movable_joints(model)));
    }
    at = found->second.get();
  }
}

void check_joint(const urdf::ModelInterface& model, const urdf::Joint& joint,
                 const UrdfLines& lines) {
  const std::string where = lines.joint(joint.name) + ": joint '" + joint.name + "'";
  if (!is_finite(joint.parent_to_joint_origin_transform)) {
    throw InputError(where + " has an origin that is not finite");
  }
  if (is_free(joint) && joint.mimic != nullptr) {
    throw InputError(where + " is floating or planar: it cannot mimic another");
  }
  if (!is_movable(joint)) return;
  check_axis_and_limits(joint, where);
  check_mimic(model, joint, where);
}

std::vector<urdf::LinkConstSharedPtr> children(const urdf::Link& link) {
  std::vector<urdf::LinkConstSharedPtr> sorted(link.child_links.begin(), link.child_links.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return a->parent_joint->name < b->parent_joint->name;
  });
  return sorted;
}

}  // namespace

bool is_free(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::FLOATING || joint.type == urdf::Joint::PLANAR;
}

bool is_active(const urdf::Joint& joint) { return is_movable(joint) && joint.mimic == nullptr; }

std::vector<urdf::LinkConstSharedPtr> check_urdf(const urdf::ModelInterface& model,
                                                 const UrdfLines& lines) {
  for (const auto& [name, joint] : model.joints_) check_joint(model, *joint, lines);
  std::vector<urdf::LinkConstSharedPtr> ordered;
  std::vector<urdf::LinkConstSharedPtr> open = {model.getRoot()};
  while (!open.empty()) {
    ordered.push_back(open.back());
    open.pop_back();
    const auto next = children(*ordered.back());
    open.insert(open.end(), next.rbegin(), next.rend());
  }
  return ordered;
}

}  // namespace pliant
