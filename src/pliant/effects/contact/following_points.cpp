#include "pliant/effects/contact/following_points.h"

#include <algorithm>

namespace pliant {

FollowingPoints::FollowingPoints(const EmbeddedPoints* seeds, const SurfaceBends* bends)
    : seeds_(seeds), bends_(seeds != nullptr ? bends : nullptr) {
  if (!follows()) return;
  points_ = *seeds;
  contacts_of_.assign(static_cast<std::size_t>(points_.size()), 0);
}

void FollowingPoints::rewind() {
  for (const Moved& moved : moved_) {
    points_.set_weights(moved.point, seeds_->weights().col(moved.point));
  }
  moved_.clear();
  doubles_.clear();
}

bool FollowingPoints::follow(const std::vector<Contact>& contacts, const Positions& x) {
  move(contacts, x);
  find_doubles();
  return !moved_.empty();
}

void FollowingPoints::move(const std::vector<Contact>& contacts, const Positions& x) {
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

}  // namespace pliant
