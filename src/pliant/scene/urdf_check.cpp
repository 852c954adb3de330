#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <set>

#include "pliant/math/error.h"
#include "pliant/scene/urdf_reader.h"

namespace pliant {
namespace {

bool is_finite(const urdf::Pose& pose) {
  const auto& p = pose.position;
  const auto& q = pose.rotation;
  return std::isfinite(p.x + p.y + p.z) && std::isfinite(q.x + q.y + q.z + q.w);
}

std::string type_name(int type) {
  switch (type) {
    case urdf::Joint::FLOATING:
      return "floating";
    case urdf::Joint::PLANAR:
      return "planar";
    default:
      return "unknown";
  }
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
      throw InputError(where + " mimics '" + at->mimic->joint_name +
                       "', which is no movable joint of this robot");
    }
    at = found->second.get();
  }
}

void check_joint(const urdf::ModelInterface& model, const urdf::Joint& joint,
                 const UrdfPlace& place) {
  const std::string where = place("joint", joint.name) + ": joint '" + joint.name + "'";
  if (!is_finite(joint.parent_to_joint_origin_transform)) {
    throw InputError(where + " has an origin that is not finite");
  }
  if (joint.type == urdf::Joint::FIXED) return;
  if (!is_movable(joint)) {
    throw InputError(
        fmt::format("{} is of type {}; supported are fixed, revolute, continuous, prismatic", where,
                    type_name(joint.type)));
  }
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

bool is_active(const urdf::Joint& joint) { return is_movable(joint) && joint.mimic == nullptr; }

std::vector<urdf::LinkConstSharedPtr> check_urdf(const urdf::ModelInterface& model,
                                                 const UrdfPlace& place) {
  if (model.links_.size() > kMaxLinks) {
    throw InputError(fmt::format("{}: the robot has {} links, but at most {} are allowed",
                                 place("robot", model.name_), model.links_.size(), kMaxLinks));
  }
  for (const auto& [name, joint] : model.joints_) check_joint(model, *joint, place);
  std::vector<urdf::LinkConstSharedPtr> ordered;
  std::set<std::string> seen;
  std::vector<urdf::LinkConstSharedPtr> open = {model.getRoot()};
  while (!open.empty()) {
    const urdf::LinkConstSharedPtr link = open.back();
    open.pop_back();
    if (!seen.insert(link->name).second) {
      throw InputError(place("link", link->name) + ": link '" + link->name +
                       "' is the child of two joints");
    }
    ordered.push_back(link);
    const auto next = children(*link);
    open.insert(open.end(), next.rbegin(), next.rend());
  }
  for (const auto& [name, link] : model.links_) {
    if (seen.count(name) == 0) {
      throw InputError(place("link", name) + ": link '" + name +
                       "' is not connected to the root link '" + model.getRoot()->name + "'");
    }
  }
  return ordered;
}

}  // namespace pliant
