#include "pliant/elements/attachment_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/math/error.h"

namespace pliant {
namespace {

void check_point(const Eigen::Vector3d& point) {
  if (point.allFinite()) return;
  throw InputError(fmt::format("attachment: the point ({}, {}, {}) m is not finite", point[0],
                               point[1], point[2]));
}

void check(const AttachmentSet::Attachment& attachment) {
  check_point(attachment.point);
  const double stiffness = attachment.stiffness;
  if (std::isfinite(stiffness) && stiffness > 0.0) return;
  throw InputError(
      fmt::format("attachment: stiffness is {} N/m, but must be positive and finite", stiffness));
}

}  // namespace

int AttachmentSet::add(int particle, const Eigen::Vector3d& point, double stiffness) {
  if (particle < 0 || particle >= particles_) {
    throw InputError(
        fmt::format("attachment: particle {} is outside [0, {}]", particle, particles_ - 1));
  }
  const auto same = [&](const Attachment& a) { return a.particle == particle; };
  const auto other = std::find_if(attachments_.begin(), attachments_.end(), same);
  if (other != attachments_.end()) {
    throw InputError(
        fmt::format("attachment: particle {} has attachment {} already; move its target or remove "
                    "it first",
                    particle, other->handle));
  }
  const Attachment attachment = {next_handle_, particle, point, stiffness};
  check(attachment);
  ++version_;
  attachments_.push_back(attachment);
  multipliers_.setZero(3, size());
  return next_handle_++;
}

std::vector<AttachmentSet::Attachment>::iterator AttachmentSet::find(int handle) {
  const auto same = [&](const Attachment& a) { return a.handle == handle; };
  const auto found = std::find_if(attachments_.begin(), attachments_.end(), same);
  if (found != attachments_.end()) return found;
  throw InputError(
      fmt::format("attachment: there is no attachment {}; the set has {}", handle, size()));
}

void AttachmentSet::remove(int handle) {
  attachments_.erase(find(handle));
  ++version_;
  multipliers_.setZero(3, size());
}

void AttachmentSet::clear() {
  attachments_.clear();
  ++version_;
  multipliers_.resize(3, 0);
}

void AttachmentSet::set_target(int handle, const Eigen::Vector3d& point) {
  check_point(point);
  find(handle)->point = point;
}

void AttachmentSet::move_frame(const Eigen::Isometry3d& start, const Eigen::Isometry3d& end) {
  if (!start.matrix().allFinite() || !end.matrix().allFinite()) {
    throw InputError("attachment: the frame's pose is not finite");
  }
  start_ = start;
  pose_ = end;
}

void AttachmentSet::write(StateArchive& numbers) const {
  numbers.write_all(pose_.matrix());
  numbers.write(next_handle_);
  numbers.write(size());
  for (const Attachment& a : attachments_) {
    numbers.write(a.handle);
    numbers.write(a.particle);
    numbers.write_all(a.point);
    numbers.write(a.stiffness);
  }
}

void AttachmentSet::read(StateArchive& numbers) {
  clear();
  Eigen::Isometry3d pose;
  numbers.read_all(pose.matrix());
  set_frame(pose);
  constexpr int kMostHandles = 1 << 30;
  const int next_handle = numbers.read_index(kMostHandles);
  constexpr std::size_t kNumbersOfEach = 6;
  std::vector<Attachment> attachments(numbers.read_count(kNumbersOfEach));
  std::vector<char> is_held(static_cast<std::size_t>(particles_), 0);
  for (Attachment& a : attachments) {
    a.handle = numbers.read_index(next_handle);
    a.particle = numbers.read_index(particles_);
    numbers.read_all(a.point);
    a.stiffness = numbers.read();
    check(a);
    if (std::exchange(is_held[static_cast<std::size_t>(a.particle)], 1) != 0) {
      throw InputError(fmt::format("the saved state attaches particle {} twice", a.particle));
    }
  }
  next_handle_ = next_handle;
  attachments_ = std::move(attachments);
  multipliers_.setZero(3, size());
}

double AttachmentSet::energy(const Positions& x) const {
  double sum = 0.0;
  for (const Attachment& a : attachments_) {
    sum += 0.5 * a.stiffness * (x.col(a.particle) - target(a)).squaredNorm();
  }
  return sum;
}

void AttachmentSet::add_forces(const Positions& x, Forces& f) const {
  for (const Attachment& a : attachments_) f.col(a.particle) += force(a, x);
}

void AttachmentSet::add_to_system(SystemMatrix& a) const {
  for (const Attachment& one : attachments_) a.add(one.particle, one.particle, one.stiffness);
}

void AttachmentSet::add_stiffness(const Positions&, Definiteness, StiffnessMatrix& k) const {
  for (const Attachment& a : attachments_) {
    k.add(a.particle, a.particle, a.stiffness * Eigen::Matrix3d::Identity());
  }
}

void AttachmentSet::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  for (std::size_t n = 0; n < attachments_.size(); ++n) {
    const Attachment& a = attachments_[n];
    auto multiplier = multipliers_.col(static_cast<Eigen::Index>(n));
    // Δλ (1 + h² w k) = f - λ
    const double mobility = dt * dt * inverse_mass[a.particle];
    const Eigen::Vector3d delta = (force(a, x) - multiplier) / (1.0 + mobility * a.stiffness);
    multiplier += delta;
    x.col(a.particle) += mobility * delta;
  }
}

Eigen::Matrix<double, 6, 1> AttachmentSet::wrench(const Positions& x) const {
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
  for (const Attachment& a : attachments_) {
    const Eigen::Vector3d pull = -force(a, x);
    sum.head<3>() += pull;
    sum.tail<3>() += (target(a) - pose_.translation()).cross(pull);
  }
  return sum;
}

}  // namespace pliant
