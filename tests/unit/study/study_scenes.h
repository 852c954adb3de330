#pragma once

#include "pliant/scene/scene.h"
#include "pliant/study/accuracy/accuracy_options.h"

namespace pliant {

/// A cloth of 5 x 4 vertices that swings from two corners; line 12 is its solver.
constexpr const char* kSmallScene = R"(time_step: 0.005
bodies:
  - name: cloth
    model: cloth
    geometry: {grid: {size: [0.4, 0.3], vertices: [5, 4]}}
    material: {areal_density: 0.2, stretch_warp: 20, stretch_weft: 20, shear: 2, bending: 1e-5}
    fixed: [{corner: upper_left}, {corner: upper_right}]
    rotation_rpy: [0.3, 0.1, 0]
effects:
  gravity: {acceleration: [0, 0, -9.81]}
  damping: {rate: 0.5}
solver: {name: xpbd, iterations: 20}
)";

/// The same cloth falling on a ball on the ground.
constexpr const char* kContactScene = R"(time_step: 0.005
bodies:
  - name: cloth
    model: cloth
    geometry: {grid: {size: [0.4, 0.3], vertices: [5, 4]}}
    position: [0, 0, 0.22]
    velocity: [0, 0, -1]
    material: {areal_density: 0.2, stretch_warp: 20, stretch_weft: 20, shear: 2, bending: 1e-5}
obstacles:
  - {name: ground, shape: plane}
  - {name: ball, shape: sphere, radius: 0.1, position: [0, 0, 0.1]}
effects:
  gravity: {acceleration: [0, 0, -9.81]}
  contact: {thickness: 0.002}
  friction: {coefficient: 0.5}
solver: {name: xpbd, iterations: 20}
)";

/// A study of two solvers that takes a few milliseconds.
inline AccuracyOptions small_study() {
  AccuracyOptions options;
  options.solvers = {"xpbd", "jacobi"};
  options.references = {"newton", "lbfgs"};
  options.iterations = {1, 8, 64};
  options.steps = 6;
  options.samples = 2;
  options.repeats = 2;
  return options;
}

}  // namespace pliant
