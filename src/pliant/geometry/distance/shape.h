#ifndef PLIANT_GEOMETRY_SHAPE_H_
#define PLIANT_GEOMETRY_SHAPE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <variant>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

class Box;
class Capsule;
class Cylinder;
class MeshShape;
class Plane;
class Shape;
class Sphere;

// A shape as what it is, for those who need its sizes; `const Shape*` of any other kind.
using AnyShape = std::variant<const Shape*, const Plane*, const Sphere*, const Box*, const Capsule*,
                              const Cylinder*, const MeshShape*>;

struct SurfacePoint {
  double distance;         // signed distance to the surface [m], negative inside
  Eigen::Vector3d normal;  // unit outward gradient of the distance
};

// A solid that obstacles are made of, in its own frame [m]. Thread-safe: queries change nothing.
// For every finite point up to 1e100 m away queries return finite values and a unit normal, also
// where the gradient does not exist (centre, axis, medial surface): there, one fixed choice of its
// limits.
class Shape {
 public:
  virtual ~Shape() = default;

  virtual SurfacePoint query(const Eigen::Vector3d& p) const = 0;
  virtual double distance(const Eigen::Vector3d& p) const { return query(p).distance; }

  // Encloses the solid. Infinite sides for a plane: do not rotate such a box.
  virtual Eigen::AlignedBox3d bounds() const = 0;

  // For display, outward winding.
  virtual TriangleMesh surface() const = 0;

  virtual AnyShape as_any() const { return this; }

  // The name of the kind, as scene files spell it.
  virtual std::string name() const = 0;

  // Whether the solid is convex and its distance exact, hence a convex function.
  virtual bool convex() const = 0;
};

// The shape as one of type `Kind`, or null.
template <class Kind>
const Kind* as(const Shape& shape) {
  const AnyShape any = shape.as_any();
  const Kind* const* found = std::get_if<const Kind*>(&any);
  return found == nullptr ? nullptr : *found;
}

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_SHAPE_H_
