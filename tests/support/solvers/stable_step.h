#pragma once

#include <memory>

#include "support/measures.h"

namespace pliant {

/// The scene's time step, halved until its solver no longer calls it unstable.
inline double stable_step(ClothScene scene) {
  for (;; scene.time_step *= 0.5) {
    const auto world = make_world(scene);
    world->step();
    if (!warns(*world, "unstable_step")) return scene.time_step;
  }
}

/// With another geometry than the scene's grid.
inline std::unique_ptr<World> make_stable_world(ClothScene scene, const BodyGeometry& geometry) {
  for (;; scene.time_step *= 0.5) {
    const auto world = make_world(scene, geometry);
    world->step();
    if (!warns(*world, "unstable_step")) return make_world(scene, geometry);
  }
}

inline std::unique_ptr<World> make_stable_world(ClothScene scene) {
  scene.time_step = stable_step(scene);
  return make_world(scene);
}

}  // namespace pliant
