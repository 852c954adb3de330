#ifndef PLIANT_GEOMETRY_PRIMITIVE_SHAPES_H_
#define PLIANT_GEOMETRY_PRIMITIVE_SHAPES_H_

#include <Eigen/Core>
#include <string>

#include "pliant/geometry/distance/shape.h"

namespace pliant {

// Distances are exact everywhere, inside too. Constructors throw InputError, naming the field and
// its range, unless sizes are within [kMinShapeSize, kMaxShapeSize].
constexpr double kMinShapeSize = 1e-9;  // [m]
constexpr double kMaxShapeSize = 1e9;   // [m]

// The half space z <= 0. Shown as a square of 2 m.
class Plane final : public Shape {
 public:
  SurfacePoint query(const Eigen::Vector3d& p) const override;
  double distance(const Eigen::Vector3d& p) const override { return p.z(); }
  Eigen::AlignedBox3d bounds() const override;
  TriangleMesh surface() const override;
  AnyShape as_any() const override { return this; }
  std::string name() const override { return "plane"; }
  bool convex() const override { return true; }
};

// Centred at the origin. Normal at the centre: +z.
class Sphere final : public Shape {
 public:
  explicit Sphere(double radius);  // [m]
  SurfacePoint query(const Eigen::Vector3d& p) const override;
  double distance(const Eigen::Vector3d& p) const override { return p.norm() - radius_; }
  Eigen::AlignedBox3d bounds() const override;
  TriangleMesh surface() const override;
  AnyShape as_any() const override { return this; }
  std::string name() const override { return "sphere"; }
  bool convex() const override { return true; }
  double radius() const { return radius_; }

 private:
  double radius_;
};

// Centred at the origin, along the axes. Inside, where faces are equally near: z before y before x,
// and the positive side.
class Box final : public Shape {
 public:
  explicit Box(const Eigen::Vector3d& size);  // full extents [m]
  SurfacePoint query(const Eigen::Vector3d& p) const override;
  double distance(const Eigen::Vector3d& p) const override;
  Eigen::AlignedBox3d bounds() const override;
  TriangleMesh surface() const override;
  AnyShape as_any() const override { return this; }
  std::string name() const override { return "box"; }
  bool convex() const override { return true; }
  Eigen::Vector3d size() const { return 2.0 * half_; }

 private:
  Eigen::Vector3d half_;
};

// A cylinder along z, centred at the origin, with half spheres on both ends. Normal on the axis:
// +x.
class Capsule final : public Shape {
 public:
  Capsule(double radius, double length);  // [m]; length of the cylinder part
  SurfacePoint query(const Eigen::Vector3d& p) const override;
  double distance(const Eigen::Vector3d& p) const override;
  Eigen::AlignedBox3d bounds() const override;
  TriangleMesh surface() const override;
  AnyShape as_any() const override { return this; }
  std::string name() const override { return "capsule"; }
  bool convex() const override { return true; }
  double radius() const { return radius_; }
  double length() const { return 2.0 * half_length_; }

 private:
  double radius_;
  double half_length_;
};

// Along z, centred at the origin, with flat ends. Inside, where side and end are equally near: the
// end. Radial normal on the axis: +x.
class Cylinder final : public Shape {
 public:
  Cylinder(double radius, double length);  // [m]
  SurfacePoint query(const Eigen::Vector3d& p) const override;
  double distance(const Eigen::Vector3d& p) const override;
  Eigen::AlignedBox3d bounds() const override;
  TriangleMesh surface() const override;
  AnyShape as_any() const override { return this; }
  std::string name() const override { return "cylinder"; }
  bool convex() const override { return true; }
  double radius() const { return radius_; }
  double length() const { return 2.0 * half_length_; }

 private:
  double radius_;
  double half_length_;
};

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_PRIMITIVE_SHAPES_H_
