#include "pliant/effects/contact/redundant_contacts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {
namespace {

// Groups that a place is compared with: those of round surfaces are as many as its places.
constexpr int kGroupsLookedAt = 16;
// Normals that differ by less are of one plane: over a metre that is a micrometre.
constexpr double kSameNormal = 1e-6;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Distance of `at` to the right of the line through two places [m].
double beyond(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& at) {
  const Eigen::Vector2d along = to - from;
  return cross(at - from, along) / along.norm();
}

}  // namespace

const std::vector<char>& RedundantContacts::find() {
  is_redundant_.assign(places_.size(), 0);
  group();
  order_.resize(places_.size());
  std::iota(order_.begin(), order_.end(), 0);
  const auto group_of = [this](int k) {
    return group_of_[static_cast<std::size_t>(order_[static_cast<std::size_t>(k)])];
  };
  std::sort(order_.begin(), order_.end(), [this](int a, int b) {
    const int one = group_of_[static_cast<std::size_t>(a)];
    const int other = group_of_[static_cast<std::size_t>(b)];
    return one != other ? one < other : a < b;
  });
  for (int first = 0, end = 0; first < size(); first = end) {
    while (end < size() && group_of(end) == group_of(first)) ++end;
    if (end - first < 3) continue;
    flatten(first, end);
    find_in_plane();
  }
  return is_redundant_;
}

void RedundantContacts::group() {
  group_of_.resize(places_.size());
  leaders_.clear();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const auto is_alike = [&](int leader) {
      const Place& other = places_[static_cast<std::size_t>(leader)];
      return other.pair == places_[i].pair &&
             (other.normal - places_[i].normal).squaredNorm() < kSameNormal * kSameNormal;
    };
    const auto count = static_cast<int>(leaders_.size());
    int group = count - 1;
    const int last = std::max(0, count - kGroupsLookedAt);
    while (group >= last && !is_alike(leaders_[static_cast<std::size_t>(group)])) --group;
    if (group < last) {
      group = count;
      leaders_.push_back(static_cast<int>(i));
    }
    group_of_[i] = group;
  }
}

void RedundantContacts::flatten(int first, int end) {
  const auto place = [this](int k) -> const Place& {
    return places_[static_cast<std::size_t>(order_[static_cast<std::size_t>(k)])];
  };
  const Place& leader = place(first);
  const Eigen::Vector3d u = leader.normal.unitOrthogonal(), v = leader.normal.cross(u);
  flat_.clear();
  for (int k = first; k < end; ++k) {
    const Eigen::Vector3d arm = place(k).position - leader.position;
    flat_.push_back({{arm.dot(u), arm.dot(v)}, place(k).gap, order_[static_cast<std::size_t>(k)]});
  }
}

void RedundantContacts::find_in_plane() {
  find_outline();
  Slope slope;
  if (!find_slope(slope)) return;
  for (int k = 0; k < static_cast<int>(flat_.size()); ++k) {
    const Flat& flat = flat_[static_cast<std::size_t>(k)];
    // One that is nearer than the corners' plane is of a face that bulges.
    if (flat.gap < slope(flat.at) - tolerance_) continue;
    if (std::find(outline_.begin(), outline_.end(), k) != outline_.end()) continue;
    is_redundant_[static_cast<std::size_t>(flat.place)] = 1;
  }
}

void RedundantContacts::find_outline() {
  outline_.clear();
  Eigen::AlignedBox2d box;
  for (const Flat& flat : flat_) box.extend(flat.at);
  const int axis = box.sizes().x() >= box.sizes().y() ? 0 : 1;
  const auto [low, high] =
      std::minmax_element(flat_.begin(), flat_.end(),
                          [axis](const Flat& a, const Flat& b) { return a.at[axis] < b.at[axis]; });
  const auto from = static_cast<int>(low - flat_.begin());
  const auto to = static_cast<int>(high - flat_.begin());
  outline_.push_back(from);
  if (box.sizes()[axis] <= tolerance_) return;
  add_beyond(from, to);
  outline_.push_back(to);
  add_beyond(to, from);
  straighten_outline();
}

void RedundantContacts::add_beyond(int from, int to) {
  int farthest = -1;
  double most = tolerance_;
  for (int k = 0; k < static_cast<int>(flat_.size()); ++k) {
    const double distance = beyond(at(from), at(to), at(k));
    if (!(distance > most)) continue;
    farthest = k;
    most = distance;
  }
  if (farthest < 0) return;
  add_beyond(from, farthest);
  outline_.push_back(farthest);
  add_beyond(farthest, to);
}

void RedundantContacts::straighten_outline() {
  // Places at the end of an axis may lie within a side that stands across it.
  for (std::size_t k = 0; k < outline_.size() && outline_.size() > 2;) {
    const std::size_t count = outline_.size();
    const Eigen::Vector2d before = at(outline_[(k + count - 1) % count]);
    const Eigen::Vector2d after = at(outline_[(k + 1) % count]);
    if (std::abs(beyond(before, after, at(outline_[k]))) <= tolerance_) {
      outline_.erase(outline_.begin() + static_cast<std::ptrdiff_t>(k));
    } else {
      ++k;
    }
  }
}

bool RedundantContacts::find_slope(Slope& slope) const {
  const auto flat = [this](int corner) -> const Flat& {
    return flat_[static_cast<std::size_t>(corner)];
  };
  const auto farthest = [&](const auto& distance) -> const Flat& {
    return flat(*std::max_element(outline_.begin(), outline_.end(), [&](int a, int b) {
      return distance(flat(a).at) < distance(flat(b).at);
    }));
  };
  const Flat& a = flat(outline_.front());
  slope = {a.at, a.gap, Eigen::Vector2d::Zero()};
  if (outline_.size() == 1) return true;
  const Flat& b =
      farthest([&](const Eigen::Vector2d& place) { return (place - a.at).squaredNorm(); });
  const Eigen::Vector2d along = b.at - a.at;
  slope.gradient = (b.gap - a.gap) / along.squaredNorm() * along;
  if (outline_.size() == 2) return true;
  const Flat& c =
      farthest([&](const Eigen::Vector2d& place) { return std::abs(cross(along, place - a.at)); });
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()) / along.norm();
  slope.gradient += (c.gap - slope(c.at)) / across.dot(c.at - a.at) * across;
  return std::all_of(outline_.begin(), outline_.end(), [&](int corner) {
    return std::abs(flat(corner).gap - slope(flat(corner).at)) <= tolerance_;
  });
}

}  // namespace pliant
