#include "pliant/effects/contact/following_points.h"

#include <algorithm>

#include "pliant/math/rotation_eigen.h"

namespace pliant {
namespace {

// What turns a body by more than points follow is a hit, which the next step does not repeat [rad].
constexpr double kMostTurn = 0.5;

/// Of the four particles of a rigid body, all of one mass.
Eigen::AngleAxisd turn_between(const Positions& from, const Positions& to) {
  const Eigen::Vector3d before = from.rowwise().mean(), now = to.rowwise().mean();
  const Eigen::Matrix3d moment = (to.colwise() - now) * (from.colwise() - before).transpose();
  return Eigen::AngleAxisd(nearest_rotation(moment));
}

}  // namespace

FollowingPoints::FollowingPoints(const EmbeddedPoints* seeds, const SurfaceBends* bends)
    : seeds_(seeds), bends_(seeds != nullptr ? bends : nullptr) {
  if (!follows()) return;
  points_ = *seeds;
  contacts_of_.assign(static_cast<std::size_t>(points_.size()), 0);
}

void FollowingPoints::begin_step(const Particles& particles, double dt) {
  for (const Moved& moved : moved_) {
    points_.set_weights(moved.point, seeds_->weights().col(moved.point));
  }
  moved_.clear();
  doubles_.clear();
  if (!follows()) return;
  undone_ = further_;
  predicted_ = expected_ = particles.x;
  const double angle = dt * dt * further_.norm();
  if (angle == 0.0 || !(angle < kMostTurn)) return;
  const Eigen::Vector3d middle = predicted_.rowwise().mean();
  const Eigen::AngleAxisd turn(angle, further_.normalized());
  expected_ = (turn.toRotationMatrix() * (predicted_.colwise() - middle)).colwise() + middle;
}

void FollowingPoints::end_step(const Positions& x, double dt) {
  if (!follows() || predicted_.cols() != x.cols()) return;
  const Eigen::AngleAxisd turn = turn_between(predicted_, x);
  further_ = turn.angle() / (dt * dt) * turn.axis();
}

bool FollowingPoints::follow(const std::vector<Contact>& contacts) {
  move(contacts);
  find_doubles();
  return !moved_.empty();
}

void FollowingPoints::move(const std::vector<Contact>& contacts) {
  const Positions& x = expected_;
  for (const Contact& contact : contacts) ++contacts_of_[static_cast<std::size_t>(contact.point)];
  for (const Contact& contact : contacts) {
    int& count = contacts_of_[static_cast<std::size_t>(contact.point)];
    if (count == 1 && bends_->spacing(contact.point) > 0.0) {
      const int point = contact.point;
      points_.set_weights(point, bends_->farthest(point, *seeds_, x, contact.normal));
      const Eigen::Vector3d position = points_.position(x, point);
      moved_.push_back({contact.obstacle, point, (position - seeds_->position(x, point)).norm(),
                        false, position});
    }
    count = 0;
  }
}

void FollowingPoints::find_doubles() {
  constexpr double kTooNear = 0.5;  // of the points' spacing
  std::sort(moved_.begin(), moved_.end(), [](const Moved& a, const Moved& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.point < b.point;
  });
  for (std::size_t k = 0; k < moved_.size(); ++k) {
    const double least = kTooNear * bends_->spacing(moved_[k].point);
    moved_[k].is_double = std::any_of(
        moved_.begin(), moved_.begin() + static_cast<std::ptrdiff_t>(k), [&](const Moved& nearer) {
          return !nearer.is_double && nearer.obstacle == moved_[k].obstacle &&
                 (nearer.position - moved_[k].position).norm() < least;
        });
    if (moved_[k].is_double) doubles_.push_back(moved_[k].point);
  }
  std::sort(doubles_.begin(), doubles_.end());
}

void FollowingPoints::leave_out_doubles(std::vector<Contact>& contacts) const {
  if (doubles_.empty()) return;
  const auto is_double = [&](const Contact& contact) {
    return std::binary_search(doubles_.begin(), doubles_.end(), contact.point);
  };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), is_double), contacts.end());
}

void FollowingPoints::roll(std::vector<Contact>& contacts, const Particles& particles,
                           const Positions& x) const {
  if (!follows() || contacts.empty()) return;
  const Eigen::AngleAxisd turn = turn_between(particles.x_start, x);
  for (Contact& contact : contacts) {
    if (bends_->spacing(contact.point) == 0.0) continue;
    contact.surface_motion -= lacks(contact, turn, particles.x_start, x);
  }
}

Eigen::Vector3d FollowingPoints::lacks(const Contact& contact, const Eigen::AngleAxisd& turn,
                                       const Positions& start, const Positions& x) const {
  const Eigen::Vector3d arm = points_.position(x, contact.point) - x.rowwise().mean();
  const Eigen::Vector3d was = points_.position(start, contact.point) - start.rowwise().mean();
  const Eigen::Vector3d lacks = turn.angle() * turn.axis().cross(arm) - (arm - was);
  const Eigen::Vector3d along = lacks - contact.normal * contact.normal.dot(lacks);
  return bends_->along_bends(contact.point, *seeds_, x, contact.normal, along);
}

void FollowingPoints::save(StateArchive& numbers) const {
  if (follows()) numbers.write_all(further_);
}

void FollowingPoints::load(StateArchive& numbers) {
  if (!follows()) return;
  numbers.read_all(further_);
  undone_ = further_;
}

}  // namespace pliant
