#pragma once

#include <string>
#include <vector>

#include "pliant/core/world.h"

namespace pliant {

/// One sentence for each pair of a body that `contact` acts on and an obstacle that holds some of
/// its free vertices at the start, deeper than the thousandth part of the body's size: contact
/// pushes them out as the scene begins, so that it does not start at rest. Liquids are no obstacles
/// here.
std::vector<std::string> find_starts_in_obstacles(const World& world);

}  // namespace pliant
