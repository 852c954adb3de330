#include "pliant/models/reduced/files/smooth_bodies.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pliant/geometry/distance/smooth_shapes.h"

namespace pliant {
namespace {

using Point = Eigen::Vector3d;

/// The same solid, `scale` times as large.
SmoothShape scaled(SmoothShape body, double scale) {
  const auto distance = body.shape.distance;
  const auto fixed = body.fixed;
  body.shape.distance = [distance, scale](const Point& p) { return scale * distance(p / scale); };
  body.fixed = [fixed, scale](const Point& p) { return fixed(p / scale); };
  body.shape.bounds = {scale * body.shape.bounds.min(), scale * body.shape.bounds.max()};
  body.cell_size *= scale;
  body.surface_spacing *= scale;
  body.loaded *= scale;
  return body;
}

/// A point and its mirror image at the plane y = 0 are the same.
Point folded(const Point& p) { return {p.x(), std::abs(p.y()), p.z()}; }

/// What is above the floor.
double cut_at_floor(double distance, const Point& p) { return std::max(distance, -p.z()); }

/// G. Taubin's heart, (x² + 9/4 y² + z² - 1)³ - x² z³ - 9/80 y² z³ < 0, by the cube root of both
/// terms, since the cubes have no slope where the surface crosses z = 0.
double heart_distance(const Point& p) {
  const Eigen::Array3d square = p.array().square();
  const double sphere = square[0] + 2.25 * square[1] + square[2] - 1.0;
  return 0.5 * (sphere - std::cbrt(square[0] + 9.0 / 80.0 * square[1]) * p.z());
}

double bridge_distance(const Point& p) {
  constexpr double kSpan = 0.93, kRise = 0.47, kRib = 0.10;  // half span, height, their place in y
  const Point q(std::abs(p.x()), std::abs(p.y()), p.z());
  const double deck = rounded_box(q, {0, 0, 0.55}, {1.0, 0.15, 0.05}, 0.02);
  const double abutment = rounded_box(q, {0.95, 0, 0.29}, {0.07, 0.15, 0.31}, 0.02);
  // Two ribs along an ellipse, whose distance is that of its level set.
  const double level = std::hypot(q.x() / kSpan, q.z() / kRise);
  const double slope =
      std::hypot(q.x() / (kSpan * kSpan), q.z() / (kRise * kRise)) / std::max(level, 1e-9);
  const double rib = std::hypot((level - 1.0) / std::max(slope, 0.1), q.y() - kRib) - 0.05;
  double columns = 1.0;
  for (const double x : {0.32, 0.52, 0.72}) {
    const double foot = kRise * std::sqrt(1.0 - x * x / (kSpan * kSpan));
    columns = std::min(columns, round_cone(q, {x, kRib, foot}, 0.045, {x, kRib, 0.55}, 0.045));
  }
  const double frame = blended(blended(deck, rib, 0.05), columns, 0.03);
  return cut_at_floor(blended(frame, abutment, 0.03), p);
}

double tower_distance(const Point& p) {
  const Point q(std::abs(p.x()), std::abs(p.y()), p.z());
  const double z = std::clamp(q.z(), 0.0, 1.3);
  const double apart = 0.30 * std::exp(-1.9 * z), half = 0.075 - 0.025 * z;
  const double slope = std::hypot(1.0, std::sqrt(2.0) * 1.9 * apart);
  const double leg =
      rounded_box({q.x() - apart, q.y() - apart, 0.0}, Point::Zero(), {half, half, 1.0}, 0.025) /
      slope;
  const double legs = std::max(leg, q.z() - 1.3);
  const double low = rounded_box(q, {0, 0, 0.45}, {0.22, 0.22, 0.04}, 0.02);
  const double high = rounded_box(q, {0, 0, 0.92}, {0.14, 0.14, 0.035}, 0.02);
  const double spire = round_cone(q, {0, 0, 1.1}, 0.075, {0, 0, 1.97}, 0.03);
  const double body = blended(blended(legs, low, 0.03), high, 0.03);
  return cut_at_floor(blended(body, spire, 0.06), p);
}

/// Limbs of a horse that looks along x, those beside the middle as on its left.
struct Limb {
  Point from;
  double from_radius;
  Point to;
  double to_radius;
};

double horse_distance(const Point& p) {
  static const std::array<Limb, 5> kTrunk = {{{{-0.40, 0, 0.83}, 0.21, {0.00, 0, 0.80}, 0.19},
                                              {{0.00, 0, 0.80}, 0.19, {0.36, 0, 0.82}, 0.20},
                                              {{0.40, 0, 0.88}, 0.17, {0.72, 0, 1.26}, 0.095},
                                              {{0.71, 0, 1.31}, 0.10, {1.00, 0, 1.10}, 0.065},
                                              {{-0.58, 0, 0.92}, 0.05, {-0.72, 0, 0.70}, 0.07}}};
  static const std::array<Limb, 10> kLimbs = {
      {{{-0.72, 0, 0.70}, 0.07, {-0.76, 0, 0.42}, 0.05},  // the rest of the tail
       {{0.36, 0, 1.03}, 0.05, {0.66, 0, 1.39}, 0.04},    // mane
       {{0.66, 0.055, 1.38}, 0.045, {0.65, 0.07, 1.50}, 0.02},
       {{0.36, 0.10, 0.74}, 0.12, {0.37, 0.13, 0.40}, 0.066},
       {{0.37, 0.13, 0.40}, 0.066, {0.35, 0.13, 0.10}, 0.056},
       {{0.35, 0.13, 0.10}, 0.056, {0.37, 0.13, 0.03}, 0.068},
       {{-0.46, 0.10, 0.76}, 0.16, {-0.46, 0.13, 0.56}, 0.10},
       {{-0.46, 0.13, 0.56}, 0.10, {-0.57, 0.13, 0.40}, 0.066},
       {{-0.57, 0.13, 0.40}, 0.066, {-0.52, 0.13, 0.10}, 0.056},
       {{-0.52, 0.13, 0.10}, 0.056, {-0.50, 0.13, 0.03}, 0.068}}};
  const Point q = folded(p);
  double body = 1.0;
  for (const Limb& limb : kTrunk) {
    body = blended(body, round_cone(q, limb.from, limb.from_radius, limb.to, limb.to_radius), 0.08);
  }
  for (const Limb& limb : kLimbs) {
    body = blended(body, round_cone(q, limb.from, limb.from_radius, limb.to, limb.to_radius), 0.04);
  }
  return cut_at_floor(body, p);
}

}  // namespace

SmoothShape smooth_heart() {
  return scaled({{heart_distance, {Point(-1.2, -0.7, -1.05), Point(1.2, 0.7, 1.25)}},
                 0.17,
                 0.06,
                 [](const Point& p) { return p.z() < -0.65; },
                 {0.6, 0.4, 0.9},
                 {0.5, -1.0, 0.3}},
                0.03);
}

SmoothShape smooth_bridge() {
  return scaled({{bridge_distance, {Point(-1.05, -0.2, 0.0), Point(1.05, 0.2, 0.62)}},
                 0.055,
                 0.02,
                 [](const Point& p) { return p.z() < 0.02 || std::abs(p.x()) > 0.99; },
                 {0.0, 0.15, 0.6},
                 {0.0, 0.2, -1.0}},
                0.2);
}

SmoothShape smooth_tower() {
  return scaled({{tower_distance, {Point(-0.4, -0.4, 0.0), Point(0.4, 0.4, 2.0)}},
                 0.055,
                 0.02,
                 [](const Point& p) { return p.z() < 0.02; },
                 {0.0, 0.0, 2.0},
                 {1.0, 0.4, 0.0}},
                0.2);
}

SmoothShape smooth_horse() {
  return scaled({{horse_distance, {Point(-0.8, -0.35, 0.0), Point(1.1, 0.35, 1.55)}},
                 0.06,
                 0.025,
                 [](const Point& p) { return p.z() < 0.03; },
                 {1.0, 0.06, 1.1},
                 {-0.3, 1.0, 0.0}},
                0.2);
}

}  // namespace pliant
