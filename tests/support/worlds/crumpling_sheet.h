#pragma once

#include "support/worlds/worlds.h"

namespace pliant {

inline ParameterText fabric_of_sheets() {
  return {{"stretch_warp", "500"}, {"stretch_weft", "500"}, {"shear", "50"}, {"bending", "1e-5"}};
}

/// An upright sheet over a table, leaning a little: it falls down on itself.
inline ClothScene crumpling_sheet(bool self_contact = true) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, 16, 16};
  scene.material = fabric_of_sheets();
  scene.pose = at(0, 0, 0.2) * Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX()) *
               Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY());
  scene.obstacles = {obstacle(Plane())};
  scene.effects = {{"gravity", {}}, {"damping", {{"rate", "0.5"}}}};
  if (self_contact) scene.effects.push_back({"self_contact", {{"thickness", "0.004"}}});
  scene.effects.push_back({"contact", {}});
  scene.effects.push_back({"friction", {}});
  return scene;
}

}  // namespace pliant
