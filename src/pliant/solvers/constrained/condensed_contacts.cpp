#include "pliant/solvers/constrained/condensed_contacts.h"

#include <algorithm>

#include "pliant/laws/coulomb.h"
#include "pliant/math/vector_traits_eigen.h"

namespace pliant {
namespace {

constexpr int kMostSweeps = 300;
// Of the largest force: a change of a sweep that is none.
constexpr double kSettled = 1e-9;

}  // namespace

void CondensedContacts::begin(const Eigen::VectorXd& sums) {
  contacts_.clear();
  sides_.clear();
  sums_ = sums;
}

void CondensedContacts::append(const PointConstraint& constraint, double compliance) {
  Contact& contact = contacts_.emplace_back();
  contact.begin = contact.end = sides_.size();
  contact.gap = constraint.gap;
  contact.lowest = constraint.lowest;
  contact.friction = constraint.friction;
  contact.compliance = compliance;
  contact.normal = constraint.normal;
  contact.slip = constraint.slip;
  contact.kept_normal = constraint.normal_force;
  contact.kept_friction = constraint.friction_force;
  contact.normal_force = std::max(constraint.lowest, constraint.normal_force);
  contact.friction_force = constraint.friction_force;
}

void CondensedContacts::add(const RigidModes& modes, int particle, double weight) {
  const int body = modes.body_of(particle);
  if (body < 0) return;
  Contact& contact = contacts_.back();
  const auto first = sides_.begin() + static_cast<std::ptrdiff_t>(contact.begin);
  auto side = std::find_if(first, sides_.end(), [&](const Side& s) { return s.body == body; });
  if (side == sides_.end()) {
    sides_.emplace_back().body = body;
    contact.end = sides_.size();
    side = sides_.end() - 1;
  }
  for (int axis = 0; axis < 3; ++axis) {
    side->gradient.col(axis) += weight * modes.project(particle, Eigen::Vector3d::Unit(axis));
  }
}

void CondensedContacts::prepare(const RigidModes& modes) {
  motions_.resize(6 * modes.count());
  for (int b = 0; b < modes.count(); ++b) {
    motions_.segment<6>(6 * b) = modes.answer(b, sums_.segment<6>(6 * b));
  }
  for (Contact& contact : contacts_) {
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
    for (std::size_t k = contact.begin; k < contact.end; ++k) {
      Side& side = sides_[k];
      for (int axis = 0; axis < 3; ++axis) {
        side.answer.col(axis) = modes.answer(side.body, side.gradient.col(axis));
      }
      own += side.gradient.transpose() * side.answer;
    }
    contact.normal_answer = contact.normal.dot(own * contact.normal);
    // No less than any tangential answer is.
    contact.tangent_answer = own.trace() - contact.normal_answer;
    push(contact, contact.normal_force * contact.normal + contact.friction_force);
  }
}

Eigen::Vector3d CondensedContacts::displacement(const Contact& contact) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t k = contact.begin; k < contact.end; ++k) {
    sum += sides_[k].gradient.transpose() * motions_.segment<6>(6 * sides_[k].body);
  }
  return sum;
}

void CondensedContacts::push(const Contact& contact, const Eigen::Vector3d& force) {
  for (std::size_t k = contact.begin; k < contact.end; ++k) {
    motions_.segment<6>(6 * sides_[k].body) += sides_[k].answer * force;
  }
}

double CondensedContacts::relax(Contact& contact) {
  if (contact.begin == contact.end) return 0.0;
  const double along = contact.normal.dot(displacement(contact));
  const double missed =
      contact.gap + along + contact.compliance * (contact.normal_force - contact.kept_normal);
  const double normal = std::max(
      contact.lowest, contact.normal_force - missed / (contact.compliance + contact.normal_answer));
  const double normal_change = normal - contact.normal_force;
  contact.normal_force = normal;
  push(contact, normal_change * contact.normal);

  const Eigen::Vector3d moved = displacement(contact);
  const Eigen::Vector3d slip =
      contact.slip + moved - contact.normal * contact.normal.dot(moved) +
      contact.compliance * (contact.friction_force - contact.kept_friction);
  const double bound = contact.friction * std::max(0.0, normal - contact.lowest);
  const Eigen::Vector3d friction = within_disk<Eigen::Vector3d>(
      contact.friction_force - slip / (contact.compliance + contact.tangent_answer), bound);
  const Eigen::Vector3d change = friction - contact.friction_force;
  contact.friction_force = friction;
  push(contact, change);
  return std::abs(normal_change) + change.norm();
}

void CondensedContacts::solve(const RigidModes& modes) {
  prepare(modes);
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double changed = 0.0, largest = 0.0;
    for (Contact& contact : contacts_) {
      changed = std::max(changed, relax(contact));
      largest = std::max(largest, contact.normal_force);
    }
    if (changed <= kSettled * largest) return;
  }
}

}  // namespace pliant
