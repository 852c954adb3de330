#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pliant/effects/drag.h"
#include "pliant/ros/running/simulation.h"

namespace pliant {

/// What a user does to a body with the mouse, at a point of its surface [m]. All belong to the
/// simulation's thread, throw InputError for what is refused, and then nothing changed.
struct MouseTool {
  double radius = 0.03;  ///< vertices within it are meant, or the nearest one [m]
  DragSpring spring;
};

/// Grabs vertices; returns their mass centre [m].
Eigen::Vector3d grab(Simulation& simulation, std::size_t body, const Eigen::Vector3d& point,
                     const MouseTool& tool);
void drag_to(Simulation& simulation, std::size_t body, const Eigen::Vector3d& center);
void let_go(Simulation& simulation, std::size_t body);

/// What a menu of a body offers.
enum class BodyAction { kAttach, kPin, kPush, kHeat, kCool, kWet, kDry, kRelease };

/// Those of them that the body can do.
std::vector<BodyAction> actions_of(const World& world, std::size_t body);
/// As a menu shows it.
std::string title_of(BodyAction action);
/// Does it. `to`: what kAttach holds to, as ~attach names it.
Answer act(Simulation& simulation, std::size_t body, BodyAction action,
           const Eigen::Vector3d& point, const MouseTool& tool, const std::string& to = "world");

}  // namespace pliant
