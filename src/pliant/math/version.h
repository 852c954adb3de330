#pragma once

namespace pliant {

/// Of this Pliant: that of its project in CMakeLists.txt.
constexpr const char* kVersion = "0.1.0";

}  // namespace pliant
