#include "pliant/effects/self_contact/self_contact_detection.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/geometry/distance/barycentric.h"

namespace pliant {
namespace {

// Triangles or tetrahedra that a thread takes at once.
constexpr int kBlock = 512;
// Distances that agree to this share are one: of an edge's triangles the one counts that the point
// sees more of.
constexpr double kSameDistance = 1e-9;
// A point this near to a surface, as a share of the triangle's size, has no direction of its own.
constexpr double kTouching = 1e-9;
// Volume over the cube of the longest edge below which a tetrahedron is flat.
constexpr double kFlat = 1e-6;
// Weights change no more than this: in a crushed tetrahedron the place beside is far off, and its
// particles would take forces many times those of the contact.
constexpr double kMaxShift = 1.0;

template <class Found, class Search>
void search_blocks(int count, std::vector<std::vector<Found>>& blocks, std::vector<Found>& all,
                   const Search& search) {
  blocks.resize(static_cast<std::size_t>((count + kBlock - 1) / kBlock));
  parallel_for(0, static_cast<int>(blocks.size()), 1, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      std::vector<Found>& found = blocks[static_cast<std::size_t>(b)];
      found.clear();
      for (int k = b * kBlock; k < std::min(count, (b + 1) * kBlock); ++k) search(k, found);
    }
  });
  all.clear();
  for (const auto& found : blocks) all.insert(all.end(), found.begin(), found.end());
}

}  // namespace

/// One of the two places of a contact, and how it moves with its tetrahedron.
struct SelfContactDetection::Side {
  Eigen::Vector4i particles;
  Eigen::Vector4d weights;

  /// To a place beside it, in the tetrahedron as it now is.
  void shift(const Positions& x, const Eigen::Vector3d& offset) {
    const Eigen::Matrix<double, 3, 4> corners = corners_of(x, particles);
    const Eigen::Matrix3d sides = corners.rightCols<3>().colwise() - corners.col(0);
    const double size = sides.colwise().norm().maxCoeff();
    if (std::abs(sides.determinant()) > kFlat * size * size * size) {
      const Eigen::Vector4d change = Barycentric(corners).gradients * offset;
      weights += change * std::min(1.0, kMaxShift / change.norm());
    }
  }
};

void SelfContactDetection::join(const Side& point, const Side& surface, PairContact& contact) {
  contact.count = 8;
  for (int k = 0; k < 4; ++k) {
    const auto at = static_cast<std::size_t>(k);
    contact.particles[at] = point.particles[k];
    contact.weights[at] = point.weights[k];
    contact.particles[at + 4] = surface.particles[k];
    contact.weights[at + 4] = -surface.weights[k];
  }
}

SelfContactDetection::SelfContactDetection(SelfContactParts parts, const Options& options)
    : parts_(std::move(parts)),
      thickness_(options.thickness),
      margin_(options.margin),
      friction_(options.friction) {
  double size = 0.0;
  for (const EmbeddedTriangle& triangle : parts_.triangles()) {
    const Eigen::Matrix3d corners = triangle.corners(parts_.rest_surface());
    size += (corners.rowwise().maxCoeff() - corners.rowwise().minCoeff()).maxCoeff();
  }
  cell_ = size / std::max<double>(1.0, static_cast<double>(parts_.triangles().size())) +
          2.0 * (thickness_ + margin_ + parts_.bulge());
  std::vector<std::vector<int>> points(static_cast<std::size_t>(parts_.count()));
  for (int i = 0; i < parts_.points().size(); ++i) {
    points[static_cast<std::size_t>(parts_.part_of_point(i))].push_back(i);
  }
  for (std::vector<int>& part : points) part_points_.emplace_back(std::move(part));
}

void SelfContactDetection::find(const Particles& particles, double dt,
                                std::vector<PairContact>& contacts) {
  const EmbeddedPoints& points = parts_.points();
  points_.resize(3, points.size());
  motions_.resize(3, points.size());
  points.positions(particles.x, points_);
  points.positions(particles.x_start, motions_);
  motions_ = points_ - motions_;
  surface_.resize(3, parts_.surface().size());
  surface_start_.resize(3, parts_.surface().size());
  parts_.surface().positions(particles.x, surface_);
  parts_.surface().positions(particles.x_start, surface_start_);
  for (PartPoints& part : part_points_) part.build(points_, motions_, cell_);
  search_blocks(static_cast<int>(parts_.triangles().size()), near_blocks_, near_,
                [&](int t, std::vector<Near>& found) { find_near(t, found); });
  search_blocks(static_cast<int>(parts_.rest().tetrahedra.cols()), deep_blocks_, deep_,
                [&](int t, std::vector<Deep>& found) { find_deep(t, particles.x, found); });
  std::sort(near_.begin(), near_.end(), [](const Near& a, const Near& b) {
    return std::tie(a.point, a.part, a.triangle) < std::tie(b.point, b.part, b.triangle);
  });
  std::sort(deep_.begin(), deep_.end(), [](const Deep& a, const Deep& b) {
    return std::tie(a.point, a.part, a.tetrahedron) < std::tie(b.point, b.part, b.tetrahedron);
  });
  contacts.clear();
  choose(particles, dt, contacts);
}

template <class Visit>
void SelfContactDetection::for_each_near_pair(const Visit& visit) const {
  const auto before = [](const auto& a, const auto& b) {
    return std::tie(a.point, a.part) < std::tie(b.point, b.part);
  };
  auto near = near_.begin();
  auto deep = deep_.begin();
  while (near != near_.end() || deep != deep_.end()) {
    const bool has_near = deep == deep_.end() || (near != near_.end() && !before(*deep, *near));
    const bool has_deep = near == near_.end() || (deep != deep_.end() && !before(*near, *deep));
    const Near* best = nullptr;
    if (has_near) {
      const auto end = std::upper_bound(near, near_.end(), *near, before);
      best = nearest(&*near, &*near + (end - near), has_deep);
      near = end;
    }
    const Deep* first = has_deep ? &*deep : nullptr;
    if (has_deep) deep = std::upper_bound(deep, deep_.end(), *deep, before);
    // What is outside of the nearest triangle is outside, wherever the tetrahedra end.
    if (best != nullptr ? best->counts : first != nullptr) visit(best, first);
  }
}

const SelfContactDetection::Near* SelfContactDetection::nearest(const Near* begin, const Near* end,
                                                                bool is_inside) const {
  const bool is_own = parts_.part_of_point(begin->point) == begin->part;
  const Near* best = nullptr;
  for (const Near* near = begin; near != end; ++near) {
    // A point is behind the other side of its own part, too.
    if (is_own && near->alignment < 0.0 && !is_inside) continue;
    if (best == nullptr) {
      best = near;
      continue;
    }
    const double gain = best->distance - near->distance, equal = kSameDistance * near->distance;
    const bool sees_more = std::abs(near->alignment) > std::abs(best->alignment);
    if (gain > equal || (gain >= -equal && sees_more)) best = near;
  }
  return best;
}

void SelfContactDetection::choose(const Particles& particles, double dt,
                                  std::vector<PairContact>& contacts) {
  overlaps_.clear();
  for_each_near_pair([&](const Near* near, const Deep* deep) {
    if (near != nullptr || parts_.part_of_point(deep->point) == deep->part) return;
    add_path_out(nearest_surface(*deep));
  });
  for_each_near_pair([&](const Near* near, const Deep* deep) {
    const int point = near != nullptr ? near->point : deep->point;
    const int part = near != nullptr ? near->part : deep->part;
    if (const Overlap* overlap = find_overlap(parts_.part_of_point(point), part)) {
      if (deep != nullptr) add(*deep, *overlap, dt, particles, contacts);
    } else if (near != nullptr) {
      add(*near, particles, dt, contacts);
    } else {
      add(nearest_surface(*deep), particles, dt, contacts);
    }
  });
}

SelfContactDetection::Near SelfContactDetection::nearest_surface(const Deep& deep) const {
  const Eigen::Vector4i tetrahedron = parts_.rest().tetrahedra.col(deep.tetrahedron);
  const Eigen::Vector3d at = corners_of(parts_.rest().vertices, tetrahedron) * deep.weights;
  const NearestTriangle::Result nearest = parts_.nearest(deep.part, at);
  const EmbeddedTriangle& triangle = parts_.triangles()[static_cast<std::size_t>(nearest.triangle)];
  const Eigen::Vector3d weights =
      triangle_weights(triangle.corners(parts_.rest_surface()), nearest.point);
  const double distance = (points_.col(deep.point) - triangle.corners(surface_) * weights).norm();
  return {deep.point, deep.part, nearest.triangle, weights, distance, -1.0, true};
}

const SelfContactDetection::Overlap* SelfContactDetection::find_overlap(int a, int b) const {
  for (const Overlap& overlap : overlaps_) {
    if (overlap.low == std::min(a, b) && overlap.high == std::max(a, b)) return &overlap;
  }
  return nullptr;
}

void SelfContactDetection::add_path_out(const Near& near) {
  const int own = parts_.part_of_point(near.point);
  const EmbeddedTriangle& triangle = parts_.triangles()[static_cast<std::size_t>(near.triangle)];
  const Eigen::Vector3d between =
      triangle.corners(surface_) * near.weights - points_.col(near.point);
  const Eigen::Vector3d out = own < near.part ? Eigen::Vector3d(-between) : between;
  if (const Overlap* known = find_overlap(own, near.part)) {
    overlaps_[static_cast<std::size_t>(known - overlaps_.data())].out += out;
  } else {
    overlaps_.push_back({std::min(own, near.part), std::max(own, near.part), out});
  }
}

void SelfContactDetection::add(const Deep& deep, const Overlap& overlap, double dt,
                               const Particles& particles,
                               std::vector<PairContact>& contacts) const {
  const bool is_low = parts_.part_of_point(deep.point) == overlap.low;
  // Where the paths out cancel any direction is as good.
  const Eigen::Vector3d out =
      overlap.out.isZero(0.0) ? Eigen::Vector3d::UnitZ() : overlap.out.stableNormalized();
  PairContact contact;
  contact.normal = is_low ? Eigen::Vector3d(-out) : out;
  contact.friction = 0.0;
  const Side point{parts_.points().particles().col(deep.point),
                   parts_.points().weights().col(deep.point)};
  join(point, {parts_.rest().tetrahedra.col(deep.tetrahedron), deep.weights}, contact);
  contact.start = contact.relative(particles.x_start);
  contact.least = contact.normal.dot(contact.start) + kMaxPushOutSpeed * dt;
  contacts.push_back(contact);
}

void SelfContactDetection::add(const Near& near, const Particles& particles, double dt,
                               std::vector<PairContact>& contacts) const {
  const EmbeddedTriangle& triangle = parts_.triangles()[static_cast<std::size_t>(near.triangle)];
  const Eigen::Matrix3d corners = triangle.corners(surface_);
  const Eigen::Vector3d side = corners.col(1) - corners.col(0);
  const Eigen::Vector3d between = points_.col(near.point) - corners * near.weights;
  const double gap = near.alignment < 0.0 ? -near.distance : near.distance;
  PairContact contact;
  contact.normal = near.distance > kTouching * side.norm()
                       ? Eigen::Vector3d(between / gap)
                       : side.cross(corners.col(2) - corners.col(0)).stableNormalized();
  // Both forces act at one place, in the middle, so that they have no torque; not farther from
  // either than half the thickness.
  const double half = 0.5 * std::clamp(gap, -thickness_, thickness_);
  Side point{parts_.points().particles().col(near.point),
             parts_.points().weights().col(near.point)};
  Side surface{triangle.particles, triangle.weights * near.weights};
  // Other tetrahedra carry some of the triangle's corners.
  const Eigen::Vector3d embedded = corners_of(particles.x, surface.particles) * surface.weights;
  surface.shift(particles.x, corners * near.weights - embedded);
  contact.friction = friction_;
  point.shift(particles.x, -half * contact.normal);
  surface.shift(particles.x, half * contact.normal);
  join(point, surface, contact);
  contact.start = contact.relative(particles.x_start);
  const double now = contact.normal.dot(contact.relative(particles.x));
  double wanted = thickness_;
  if (parts_.part_of_point(near.point) == near.part) {
    wanted = std::min(wanted, kNearShare * rest_distance(near));
  }
  const double start_gap = gap + contact.normal.dot(contact.start) - now;
  wanted = std::min(wanted, start_gap + kMaxPushOutSpeed * dt);
  contact.least = now + (wanted - gap);
  contacts.push_back(contact);
}

}  // namespace pliant
