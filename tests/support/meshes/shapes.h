#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "pliant/geometry/distance/primitive_shapes.h"

namespace pliant {

/// Every primitive, all about 20 cm in size, by name.
inline std::shared_ptr<const Shape> primitive(const std::string& name) {
  if (name == "plane") return std::make_shared<Plane>();
  if (name == "sphere") return std::make_shared<Sphere>(0.1);
  if (name == "box") return std::make_shared<Box>(Eigen::Vector3d(0.2, 0.15, 0.1));
  if (name == "capsule") return std::make_shared<Capsule>(0.05, 0.2);
  return std::make_shared<Cylinder>(0.06, 0.2);
}

inline auto every_primitive() {
  return testing::Values("plane", "sphere", "box", "capsule", "cylinder");
}

}  // namespace pliant
