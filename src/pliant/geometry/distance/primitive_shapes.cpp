#include "pliant/geometry/distance/primitive_shapes.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "pliant/geometry/mesh/display_surface.h"
#include "pliant/laws/shapes.h"
#include "pliant/math/error.h"
#include "pliant/math/vector_traits_eigen.h"

namespace pliant {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

double checked_size(const char* shape, const char* field, double value) {
  if (value >= kMinShapeSize && value <= kMaxShapeSize) return value;
  throw InputError(fmt::format("{}: {} is {} m: allowed is [{}, {}]", shape, field, value,
                               kMinShapeSize, kMaxShapeSize));
}

AlignedBox3d symmetric_box(double x, double y, double z) {
  return AlignedBox3d(Vector3d(-x, -y, -z), Vector3d(x, y, z));
}

SurfacePoint surface_point(const ShapeDistance<Vector3d>& found) {
  return {found.distance, found.normal};
}

}  // namespace

SurfacePoint Plane::query(const Vector3d& p) const { return surface_point(distance_to_plane(p)); }

AlignedBox3d Plane::bounds() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return AlignedBox3d(Vector3d::Constant(-kInfinity), Vector3d(kInfinity, kInfinity, 0.0));
}

TriangleMesh Plane::surface() const { return square_surface(2.0); }

Sphere::Sphere(double radius) : radius_(checked_size("sphere", "radius", radius)) {}

SurfacePoint Sphere::query(const Vector3d& p) const {
  return surface_point(distance_to_sphere(p, radius_));
}

AlignedBox3d Sphere::bounds() const { return symmetric_box(radius_, radius_, radius_); }

TriangleMesh Sphere::surface() const { return capsule_surface(radius_, 0.0); }

Box::Box(const Vector3d& size)
    : half_(0.5 * checked_size("box", "size x", size.x()),
            0.5 * checked_size("box", "size y", size.y()),
            0.5 * checked_size("box", "size z", size.z())) {}

SurfacePoint Box::query(const Vector3d& p) const {
  return surface_point(distance_to_box(p, half_));
}

double Box::distance(const Vector3d& p) const {
  const Vector3d beyond = p.cwiseAbs() - half_;
  const double inside = beyond.maxCoeff();
  return inside <= 0.0 ? inside : beyond.cwiseMax(0.0).norm();
}

AlignedBox3d Box::bounds() const { return AlignedBox3d(-half_, half_); }

TriangleMesh Box::surface() const { return box_surface(half_); }

Capsule::Capsule(double radius, double length)
    : radius_(checked_size("capsule", "radius", radius)),
      half_length_(0.5 * checked_size("capsule", "length", length)) {}

SurfacePoint Capsule::query(const Vector3d& p) const {
  return surface_point(distance_to_capsule(p, radius_, half_length_));
}

double Capsule::distance(const Vector3d& p) const {
  const double beyond = std::max(std::abs(p.z()) - half_length_, 0.0);
  return std::sqrt(p.x() * p.x() + p.y() * p.y() + beyond * beyond) - radius_;
}

AlignedBox3d Capsule::bounds() const {
  return symmetric_box(radius_, radius_, half_length_ + radius_);
}

TriangleMesh Capsule::surface() const { return capsule_surface(radius_, 2.0 * half_length_); }

Cylinder::Cylinder(double radius, double length)
    : radius_(checked_size("cylinder", "radius", radius)),
      half_length_(0.5 * checked_size("cylinder", "length", length)) {}

SurfacePoint Cylinder::query(const Vector3d& p) const {
  return surface_point(distance_to_cylinder(p, radius_, half_length_));
}

double Cylinder::distance(const Vector3d& p) const {
  const double side = p.head<2>().norm() - radius_;
  const double end = std::abs(p.z()) - half_length_;
  if (side > 0.0 && end > 0.0) return std::sqrt(side * side + end * end);
  return std::max(side, end);
}

AlignedBox3d Cylinder::bounds() const { return symmetric_box(radius_, radius_, half_length_); }

TriangleMesh Cylinder::surface() const { return cylinder_surface(radius_, 2.0 * half_length_); }

}  // namespace pliant
