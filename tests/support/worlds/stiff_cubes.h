#pragma once

#include <fmt/format.h>

#include <string>

namespace pliant {

/// A scene of three turned cubes of 6 cm and 1e8 Pa that fall into a box, one on the other.
inline std::string stiff_cubes_in_a_box(double time_step) {
  std::string scene = fmt::format("time_step: {}\nbodies:\n", time_step);
  for (int k = 0; k < 3; ++k) {
    scene += fmt::format(
        "  - {{name: b{}, model: patch, geometry: {{block: {{size: [0.06, 0.06, 0.06], cells: [3, "
        "3, 3]}}}}, position: [{}, {}, {}], rotation_rpy: [{}, {}, 0.4], material: {{young: 1e8, "
        "poisson: 0.35, density: 600}}}}\n",
        k, 0.02 * k - 0.02, 0.01 * k, 0.05 + 0.08 * k, 0.2 * k, 0.3 * k);
  }
  scene += "obstacles:\n  - {name: floor, shape: plane}\n";
  for (const double side : {-0.08, 0.08}) {
    scene += fmt::format(
        "  - {{name: x{1}, shape: box, size: [0.02, 0.3, 0.2], position: [{0}, 0, 0.1]}}\n"
        "  - {{name: y{1}, shape: box, size: [0.3, 0.02, 0.2], position: [0, {0}, 0.1]}}\n",
        side, side > 0.0);
  }
  return scene +
         "effects:\n  gravity: {}\n  contact: {thickness: 0.001}\n  friction: {coefficient: 0.5}\n"
         "  body_contact: {thickness: 0.001, friction: 0.5}\n";
}

}  // namespace pliant
