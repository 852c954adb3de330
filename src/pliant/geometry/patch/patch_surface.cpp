#include "pliant/geometry/patch/patch_surface.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pliant/math/error.h"
#include "pliant/math/pi.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr int kSlabGrid = 8;          // points along an edge that find how far a patch bulges
constexpr double kReach = 2.0;        // longest edges that a surface point may be from the triangle
constexpr double kFirstGuess = 0.1;   // of a point's height, in longest edges
constexpr double kTolerance = 1e-14;  // of heights, in longest edges

/// The weights w_e. In a corner, where all products vanish, its two edges share.
std::array<double, 3> weights(const std::array<double, 3>& s) {
  std::array<double, 3> w{};
  double sum = 0.0;
  for (std::size_t e = 0; e < 3; ++e) {
    const double product = s[(e + 1) % 3] * s[(e + 2) % 3];
    w[e] = product * product;
    sum += w[e];
  }
  for (std::size_t e = 0; e < 3; ++e) w[e] = sum > 0.0 ? w[e] / sum : (s[e] > 0.5 ? 0.0 : 0.5);
  return w;
}

std::array<double, 3> as_array(const Vector3d& v) { return {v[0], v[1], v[2]}; }

}  // namespace

PatchSurface::PatchSurface(PatchBody body, const std::string& where) : body_(std::move(body)) {
  validate(body_, where);
  build_cells();
}

void PatchSurface::build_cells() {
  const TriangleMesh& base = body_.base;
  std::map<std::array<int, 2>, std::size_t> edge_of;
  for (std::size_t e = 0; e < body_.edges.size(); ++e) edge_of[body_.edges[e]] = e;
  std::vector<Vector3d> normal_sum(body_.edges.size(), Vector3d::Zero());
  const auto edge = [&](int triangle, int opposite) {
    const int a = base.triangles((opposite + 1) % 3, triangle);
    const int b = base.triangles((opposite + 2) % 3, triangle);
    return edge_of.at({std::min(a, b), std::max(a, b)});
  };
  cells_.resize(static_cast<std::size_t>(base.triangles.cols()));
  for (int t = 0; t < base.triangles.cols(); ++t) {
    Cell& cell = cells_[static_cast<std::size_t>(t)];
    for (std::size_t k = 0; k < 3; ++k) {
      cell.corners[k] = base.vertices.col(base.triangles(static_cast<Eigen::Index>(k), t));
    }
    const auto& c = cell.corners;
    cell.normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    cell.size = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
    for (int e = 0; e < 3; ++e) normal_sum[edge(t, e)] += cell.normal;
  }
  for (int t = 0; t < base.triangles.cols(); ++t) {
    Cell& cell = cells_[static_cast<std::size_t>(t)];
    for (std::size_t e = 0; e < 3; ++e) {
      const std::size_t index = edge(t, static_cast<int>(e));
      const Vector3d& from = cell.corners[(e + 1) % 3];
      cell.bisector[e] = normal_sum[index].normalized();
      const Vector3d plane = cell.bisector[e].cross(cell.corners[(e + 2) % 3] - from);
      cell.slope[e] = plane / plane.dot(cell.corners[e] - from);
      cell.offset[e] = -cell.slope[e].dot(from);
      cell.quadric[e] = body_.quadrics[index];
    }
    for (int i = 0; i <= kSlabGrid; ++i) {
      for (int j = 0; i + j <= kSlabGrid; ++j) {
        const Vector3d at(i, j, kSlabGrid - i - j);
        const double h = cell.normal.dot(point(t, at / kSlabGrid) - cell.corners[0]);
        cell.slab = std::max(cell.slab, 2.0 * std::abs(h));
      }
    }
  }
}

std::array<double, 3> PatchSurface::distances(const Cell& cell, const Vector3d& p) {
  std::array<double, 3> s{};
  for (std::size_t e = 0; e < 3; ++e) s[e] = cell.slope[e].dot(p) + cell.offset[e];
  return s;
}

PatchSurface::Blend PatchSurface::blend(const Cell& cell, const Vector3d& p) const {
  const std::array<double, 3> s = distances(cell, p);
  const std::array<double, 3> w = weights(s);
  double sum = 0.0;  // of the weights' numerators
  std::array<Vector3d, 3> rise;
  Vector3d total_rise = Vector3d::Zero();
  for (std::size_t e = 0; e < 3; ++e) {
    const std::size_t f = (e + 1) % 3, g = (e + 2) % 3;
    const double product = s[f] * s[g];
    sum += product * product;
    rise[e] = 2.0 * product * (s[g] * cell.slope[f] + s[f] * cell.slope[g]);
    total_rise += rise[e];
  }
  Blend result{0.0, Vector3d::Zero()};
  for (std::size_t e = 0; e < 3; ++e) {
    const double q = pliant::value(cell.quadric[e], p);
    result.value += w[e] * q;
    result.gradient += w[e] * pliant::gradient(cell.quadric[e], p);
    if (sum > 0.0) result.gradient += (q / sum) * (rise[e] - w[e] * total_rise);
  }
  if (!body_.dents && result.value < 0.0) result = {0.0, Vector3d::Zero()};
  return result;
}

double PatchSurface::value(int patch, const Vector3d& p) const {
  const Cell& cell = cells_[static_cast<std::size_t>(patch)];
  const double q = blend(cell, p).value;
  return -cell.normal.dot(p - cell.corners[0]) + q * q * q;
}

Vector3d PatchSurface::gradient(int patch, const Vector3d& p) const {
  const Cell& cell = cells_[static_cast<std::size_t>(patch)];
  const Blend q = blend(cell, p);
  return -cell.normal + 3.0 * q.value * q.value * q.gradient;
}

Vector3d PatchSurface::normal(int patch, const Vector3d& p) const {
  const Vector3d outward = -gradient(patch, p);
  const double length = outward.norm();
  return length > 0.0 ? Vector3d(outward / length) : cells_[static_cast<std::size_t>(patch)].normal;
}

bool PatchSurface::contains(int patch, const Vector3d& p) const {
  const Cell& cell = cells_[static_cast<std::size_t>(patch)];
  for (const double s : distances(cell, p)) {
    if (s < 0.0) return false;
  }
  if (std::abs(cell.normal.dot(p - cell.corners[0])) > cell.slab) return false;
  return value(patch, p) >= 0.0;
}

double PatchSurface::winding_number(const Vector3d& p) const {
  // Solid angles of the base triangles (van Oosterom and Strackee 1983).
  double angle = 0.0;
  for (const Cell& cell : cells_) {
    const Vector3d a = cell.corners[0] - p, b = cell.corners[1] - p, c = cell.corners[2] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                              la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * kPi);
}

bool PatchSurface::inside(const Vector3d& p) const {
  // Within a patch's five half-spaces its function decides; elsewhere the base does.
  const Cell* nearest = nullptr;
  double least = 0.0;
  for (const Cell& cell : cells_) {
    const double h = std::abs(cell.normal.dot(p - cell.corners[0]));
    if (h > cell.slab || (nearest != nullptr && h >= least)) continue;
    const std::array<double, 3> s = distances(cell, p);
    if (*std::min_element(s.begin(), s.end()) < 0.0) continue;
    nearest = &cell;
    least = h;
  }
  if (nearest != nullptr) return value(static_cast<int>(nearest - cells_.data()), p) >= 0.0;
  return winding_number(p) > 0.5;
}

Vector3d PatchSurface::point(int patch, const Vector3d& barycentric) const {
  const Cell& cell = cells_[static_cast<std::size_t>(patch)];
  for (std::size_t k = 0; k < 3; ++k) {
    if (barycentric[static_cast<Eigen::Index>(k)] == 1.0) return cell.corners[k];
  }
  const Ray up = ray(cell, barycentric);
  return up.from + height(cell, up.from, up.direction) * up.direction;
}

PatchSurface::Ray PatchSurface::ray(const Cell& cell, const Vector3d& barycentric) {
  Ray ray{Vector3d::Zero(), Vector3d::Zero()};
  const std::array<double, 3> w = weights(as_array(barycentric));
  for (std::size_t e = 0; e < 3; ++e) {
    ray.from += barycentric[static_cast<Eigen::Index>(e)] * cell.corners[e];
    ray.direction += w[e] * cell.bisector[e];
  }
  return ray;
}

PatchSurface::PointMotion PatchSurface::motion(int patch, const Vector3d& barycentric) const {
  const Cell& cell = cells_[static_cast<std::size_t>(patch)];
  const Ray up = ray(cell, barycentric);
  PointMotion motion{point(patch, barycentric), up.direction, {0.0, 0.0, 0.0}};
  // There Q = cbrt(c t), as in height(): dQ + (dQ/dt − d cbrt(c t)/dt) dt = 0. Where the surface
  // crosses the base, and in a vertex, that root is infinitely steep: the point stays.
  const double c = cell.normal.dot(up.direction);
  const double height = (motion.point - up.from).dot(up.direction) / up.direction.squaredNorm();
  const double root = std::cbrt(c * height);
  const Blend q = blend(cell, motion.point);
  const double slope = q.gradient.dot(up.direction) - c / (3.0 * root * root);
  if (root == 0.0 || barycentric.maxCoeff() == 1.0) return motion;
  const std::array<double, 3> w = weights(distances(cell, motion.point));
  for (std::size_t e = 0; e < 3; ++e) motion.rates[e] = -w[e] / slope;
  return motion;
}

/// The t at which F'(from + t direction) = 0. There Q = cbrt(c t), c = n . direction: the same
/// sign as F' everywhere, and not flat at its root as Q³ is. Newton's steps, kept within a bracket.
double PatchSurface::height(const Cell& cell, const Vector3d& from,
                            const Vector3d& direction) const {
  const double c = cell.normal.dot(direction);
  const double most = kReach * cell.size;
  const Blend base = blend(cell, from);
  if (base.value == 0.0) return 0.0;
  // The root lies on the side that Q's sign in the base says: outward where it bulges.
  const double side = base.value > 0.0 ? 1.0 : -1.0;
  double low = 0.0, high = side * most;  // the latter not known to lie beyond the root
  double t = -base.value / base.gradient.dot(direction);
  if (!(side * t > 0.0 && side * t < most)) t = side * kFirstGuess * cell.size;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Blend q = blend(cell, from + t * direction);
    const double root = std::cbrt(c * t);
    const double error = q.value - root;
    if (error == 0.0) return t;
    (side * error > 0.0 ? low : high) = t;
    const double step = -error / (q.gradient.dot(direction) - c / (3.0 * root * root));
    double next = t + step;
    // The next step would be about the square of this one. Asked first: by round-off the last step
    // may end on the bracket's low end, and its high one need not be beyond a root.
    if (std::abs(step) <= std::sqrt(kTolerance) * kFirstGuess * cell.size) return next;
    if (!(side * (next - low) > 0.0 && side * (high - next) > 0.0)) {
      next = 0.5 * (low + high);
      if (std::abs(high - low) <= kTolerance * cell.size) return next;
    }
    t = next;
  }
  return t;
}

}  // namespace pliant
