#include "pliant/effects/contact/contact_detection.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/effects/contact/opening.h"
#include "pliant/geometry/search/sweep.h"

namespace pliant {
namespace {

constexpr int kGrain = 1024;
// Single-precision balls are shrunk by their rounding error.
constexpr double kBallShrink = 1e-5;

/// Bound on how far any point within `radius` of the obstacle's origin moves in the step.
double motion_bound(const Obstacle& obstacle, double radius) {
  const Eigen::Isometry3d motion = obstacle.pose_start.inverse() * obstacle.pose_end;
  const double angle = Eigen::AngleAxisd(motion.rotation()).angle();
  return motion.translation().norm() + angle * radius;
}

Eigen::AlignedBox3d world_bounds(const Obstacle& obstacle) {
  Eigen::AlignedBox3d local = obstacle.shape->bounds();
  if (!local.min().allFinite() || !local.max().allFinite()) return local;
  return local.transformed(obstacle.pose_end);
}

bool infinite(const Eigen::AlignedBox3d& box) {
  return !box.min().allFinite() || !box.max().allFinite();
}

}  // namespace

struct ContactDetection::Query {
  const Obstacle& obstacle;
  const Positions& start_positions;
  const Positions& end_positions;
  const ContactPoints& points;
  const Particles* coasting;  // null: points will end where `end_positions` are
  double offset, margin, dt;
  double motion;  // bound on the relative motion of any point and the obstacle in the step
  double allowed_depth;
  Eigen::Isometry3d end_inverse, start_inverse;

  bool in_clear_ball(const Eigen::Vector3d& to, const Eigen::Vector4f& ball) const {
    const float radius = ball[3] - static_cast<float>(motion);
    return radius > 0.0f && (to.cast<float>() - ball.head<3>()).squaredNorm() < radius * radius;
  }

  Eigen::Vector4f clear_ball(const Eigen::Vector3d& to, double distance) const {
    const double radius = distance - offset - margin;
    const double rounding = kBallShrink * (to.cwiseAbs().maxCoeff() + std::abs(distance));
    Eigen::Vector4f ball;
    ball << to.cast<float>(), static_cast<float>(radius - rounding);
    return ball;
  }

  /// Contact that keeps the point `offset` above the tangent plane at `local` (in the frame of the
  /// obstacle), a place at signed distance `distance` from the surface. While it sticks, the
  /// point goes where the obstacle takes the place `stuck`.
  Contact contact(int point, int index, const Eigen::Vector3d& local,
                  const Eigen::Vector3d& local_normal, double distance,
                  const Eigen::Vector3d& stuck) const {
    Contact contact;
    contact.point = point;
    contact.obstacle = index;
    contact.normal = obstacle.pose_end.linear() * local_normal;
    const Eigen::Vector3d at_end = obstacle.pose_end * local;
    // Written so that an obstacle that does not turn moves all places alike, to the last digit.
    const Eigen::Matrix3d turn = obstacle.pose_end.linear() - obstacle.pose_start.linear();
    contact.surface_motion = at_end - obstacle.pose_start * local + turn * (stuck - local);
    contact.plane = contact.normal.dot(at_end) - (distance - offset);
    contact.touched = at_end - distance * contact.normal;
    return contact;
  }

  /// The same for a point that may have started too deep, at `from` in the frame of the obstacle:
  /// it is pushed out no faster than allowed.
  Contact slow_contact(int point, int index, const Eigen::Vector3d& local,
                       const Eigen::Vector3d& local_normal, double distance,
                       const Eigen::Vector3d& from) const {
    Contact slow = contact(point, index, local, local_normal, distance, from);
    const double start = slow.normal.dot(start_positions.col(point) + slow.surface_motion);
    const double need = slow.plane - start;
    double allowed = std::min(need, Opening::kFastest * dt);
    if (allowed_depth > 0.0 && need > 0.0) {
      const double depth = offset - obstacle.shape->query(from).distance;
      // The rest of the need is not for depth: the surface is curved, or it came nearer.
      allowed = std::min(allowed, need - std::clamp(depth, 0.0, std::min(need, allowed_depth)));
    }
    if (allowed < need) slow.plane = start + allowed;
    return slow;
  }

  /// The contact of a point that ends near the surface, at `to` in the frame of the obstacle as the
  /// step predicts it. What rests or is gripped does not fall along the surface as predicted: past
  /// its edge the tangent plane is another one, which would press on the point where it stays.
  Contact near_contact(int point, int index, const Eigen::Vector3d& to, const SurfacePoint& end,
                       const Eigen::Vector3d& from) const {
    // Vertices of a sheet weigh little, and go where they are predicted sooner than solids do.
    if (coasting != nullptr && points.are_embedded()) {
      const Eigen::Vector3d at = coasted(point);
      const SurfacePoint there = obstacle.shape->query(at);
      const double at_end = there.distance + there.normal.dot(to - at);
      if (is_near(there) && at_end <= end.distance + kUncovered * offset) {
        return slow_contact(point, index, at, there.normal, there.distance, from);
      }
    }
    return slow_contact(point, index, to, end.normal, end.distance, from);
  }

  /// Likewise of a point that is predicted to fall from the surface: what presses on it from above
  /// holds it there.
  void add_pressed(int point, int index, const Eigen::Vector3d& from,
                   std::vector<Contact>& contacts) const {
    if (coasting == nullptr || !is_near(obstacle.shape->query(from))) return;
    const Eigen::Vector3d at = coasted(point);
    const SurfacePoint there = obstacle.shape->query(at);
    if (!is_near(there)) return;
    contacts.push_back(slow_contact(point, index, at, there.normal, there.distance, from));
  }

  bool is_near(const SurfacePoint& place) const { return place.distance < offset + margin; }

  /// In the frame of the obstacle, where a point is after the step that no force changes.
  Eigen::Vector3d coasted(int point) const {
    return end_inverse * points.coasted(*coasting, dt, point);
  }

  void look(int point, int index, Eigen::Vector4f& ball, std::vector<Contact>& contacts) const {
    const Eigen::Vector3d to = end_inverse * end_positions.col(point);
    if (in_clear_ball(to, ball)) return;
    const SurfacePoint end = obstacle.shape->query(to);
    ball = clear_ball(to, end.distance);
    if (end.distance > offset + margin + motion) return;
    const Eigen::Vector3d from = start_inverse * start_positions.col(point);
    if ((to - from).norm() > kSafeShare * offset || end.distance <= 0.0) {
      const SweepHit hit = sweep_point(*obstacle.shape, from, to, offset);
      if (hit.hit && hit.time > 0.0) {
        contacts.push_back(contact(point, index, hit.point, hit.normal, offset, hit.point));
        return;
      }
      if (hit.hit) {
        const SurfacePoint start = obstacle.shape->query(from);
        contacts.push_back(slow_contact(point, index, from, start.normal, start.distance, from));
        return;
      }
    }
    if (is_near(end)) {
      contacts.push_back(near_contact(point, index, to, end, from));
    } else {
      add_pressed(point, index, from, contacts);
    }
  }
};

ContactDetection::ContactDetection(const std::vector<Obstacle>& obstacles, double offset,
                                   double margin, ContactPoints points)
    : obstacles_(obstacles), offset_(offset), margin_(margin), points_(points) {}

ContactDetection::Motion ContactDetection::motion_of(const Particles& particles) {
  const bool embedded = points_.are_embedded();
  if (embedded) points_.positions(particles.x, embedded_end_);
  Motion motion{embedded ? embedded_start_ : particles.x_start,
                embedded ? embedded_end_ : particles.x, Eigen::AlignedBox3d()};
  struct Reach {
    Eigen::Array3d low, high;
    double largest;  // squared
  };
  const Reach reach = parallel_reduce(
      0, static_cast<int>(motion.start.cols()), kGrain,
      [&](int begin, int end) {
        Reach part = {motion.start.col(begin), motion.start.col(begin), 0.0};
        for (int i = begin; i < end; ++i) {
          const Eigen::Array3d from = motion.start.col(i), to = motion.end.col(i);
          part.low = part.low.min(from).min(to);
          part.high = part.high.max(from).max(to);
          part.largest = std::max(part.largest, (to - from).matrix().squaredNorm());
        }
        return part;
      },
      [](const Reach& a, const Reach& b) {
        return Reach{a.low.min(b.low), a.high.max(b.high), std::max(a.largest, b.largest)};
      });
  motion.box = Eigen::AlignedBox3d(reach.low.matrix(), reach.high.matrix());
  motion.largest = std::sqrt(reach.largest);
  return motion;
}

void ContactDetection::find(const Particles& particles, double dt, std::vector<Contact>& contacts) {
  if (points_.are_embedded()) points_.positions(particles.x_start, embedded_start_);
  find(particles, dt, true, contacts);
}

void ContactDetection::find_again(const Particles& particles, double dt,
                                  std::vector<Contact>& contacts) {
  find(particles, dt, false, contacts);
}

void ContactDetection::find(const Particles& particles, double dt, bool is_prediction,
                            std::vector<Contact>& contacts) {
  if (points_.size(particles) == 0) return;
  clear_balls_.resize(obstacles_.size());
  const Motion points = motion_of(particles);
  const Eigen::AlignedBox3d& box = points.box;
  for (int o = 0; o < static_cast<int>(obstacles_.size()); ++o) {
    const Obstacle& obstacle = obstacles_[static_cast<std::size_t>(o)];
    if (obstacle.liquid) continue;
    const double radius = (box.center() - obstacle.pose_end.translation()).norm() +
                          0.5 * box.diagonal().norm() + offset_ + margin_;
    const double motion = points.largest + motion_bound(obstacle, radius);
    const Eigen::AlignedBox3d bounds = world_bounds(obstacle);
    const double reach = offset_ + margin_ + motion;
    if (!infinite(bounds) && box.exteriorDistance(bounds) > reach) continue;
    // No point is farther from the middle than a corner of the box.
    const double away = obstacle.shape->query(obstacle.pose_end.inverse() * box.center()).distance;
    if (away - 0.5 * box.diagonal().norm() > reach) continue;
    find_with(o, particles, points, motion, dt, is_prediction, contacts);
  }
}

double ContactDetection::deepest_start(const Particles& particles,
                                       const std::vector<Contact>& contacts) const {
  double deepest = 0.0;
  for (const Contact& contact : contacts) {
    const Obstacle& obstacle = obstacles_[static_cast<std::size_t>(contact.obstacle)];
    const Eigen::Vector3d from = points_.position(particles.x_start, contact.point);
    const double distance = obstacle.shape->query(obstacle.pose_start.inverse() * from).distance;
    deepest = std::max(deepest, offset_ - distance);
  }
  return deepest;
}

void ContactDetection::find_with(int obstacle, const Particles& particles, const Motion& motion,
                                 double reach, double dt, bool is_prediction,
                                 std::vector<Contact>& contacts) {
  auto& balls = clear_balls_[static_cast<std::size_t>(obstacle)];
  const int count = points_.size(particles);
  if (static_cast<int>(balls.size()) != count) {
    balls.assign(static_cast<std::size_t>(count), Eigen::Vector4f(0, 0, 0, -1));
  }
  const Obstacle& o = obstacles_[static_cast<std::size_t>(obstacle)];
  const Query sight{o,
                    motion.start,
                    motion.end,
                    points_,
                    is_prediction ? &particles : nullptr,
                    offset_,
                    margin_,
                    dt,
                    reach,
                    allowed_depth_,
                    o.pose_end.inverse(),
                    o.pose_start.inverse()};
  const auto look = [&](int begin, int end, std::vector<Contact>& found) {
    for (int i = begin; i < end; ++i) {
      if (points_.is_fixed(particles, i)) continue;
      sight.look(i, obstacle, balls[static_cast<std::size_t>(i)], found);
    }
  };
  const int parts = (count + kGrain - 1) / kGrain;
  if (parts == 1) return look(0, count, contacts);
  found_.resize(std::max(found_.size(), static_cast<std::size_t>(parts)));
  parallel_for(0, parts, 1, [&](int first, int last) {
    for (int p = first; p < last; ++p) {
      std::vector<Contact>& found = found_[static_cast<std::size_t>(p)];
      found.clear();
      look(p * kGrain, std::min(count, (p + 1) * kGrain), found);
    }
  });
  for (int p = 0; p < parts; ++p) {
    const std::vector<Contact>& found = found_[static_cast<std::size_t>(p)];
    contacts.insert(contacts.end(), found.begin(), found.end());
  }
}

}  // namespace pliant
