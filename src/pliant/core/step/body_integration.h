#pragma once

#include <string_view>

namespace pliant {

struct Body;

/// The name of the time integration by which a body steps; empty: its solver has one of its own.
std::string_view time_integration_of(const Body& body);

}  // namespace pliant
