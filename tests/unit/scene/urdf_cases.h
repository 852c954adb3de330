#pragma once

#include <string>
#include <vector>

namespace pliant {

/// The robot that urdf_cases() break: every kind of element, a mesh, two movable joints. Cases
/// refer to its line numbers.
extern const char* const kArmUrdf;

/// One known way to break a URDF.
struct UrdfCase {
  std::string name;                ///< of letters and digits
  std::string broken;              ///< the whole URDF
  std::vector<std::string> parts;  ///< of what is said of it, its place first
  std::string twin;                ///< a sound URDF that differs from it as little as can be
  bool is_refused = true;          ///< false: it is taken with a warning
};

/// Made anew from kArmUrdf, each by one change. `hand.obj`, which it names, is a closed mesh, and
/// `text.obj` none.
std::vector<UrdfCase> urdf_cases();

}  // namespace pliant
