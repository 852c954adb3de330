#pragma once

#include <urdf_model/model.h>

#include <kdl/tree.hpp>
#include <string>
#include <vector>

#include "pliant/math/loaded_library.h"

namespace pliant {

/// What Pliant takes of ROS's own libraries: kdl_parser, and rospack where that is there. They
/// bring some thirty others, which take as long to load as a small scene to run, so that the first
/// robot or package:// name alone loads them, as libpliant_robots.so (src/pliant/robots/).
LoadedLibrary& robot_library();
/// Throws InputError, which says what to do: a function of it, or the library, is not there.
[[noreturn]] void throw_no_robot_library(const LoadedLibrary& library);

/// The function that `library` exports under a name of those below. Throws InputError.
template <class Function>
Function& robot_function(const char* symbol, LoadedLibrary& library = robot_library()) {
  auto* function = library.find<Function>(symbol);
  if (function == nullptr) throw_no_robot_library(library);
  return *function;
}

/// Makes the tree of a robot's links; whether that was possible.
using MakeRobotTree = bool(const urdf::ModelInterface& model, KDL::Tree& tree);
constexpr const char* kMakeRobotTree = "pliant_robot_tree";

/// Finds the folder of a ROS package; "" without. From any thread.
using FindRosPackage = void(const std::string& package, std::string& folder);
constexpr const char* kFindRosPackage = "pliant_ros_package";

/// Names all ROS packages. From any thread.
using NameRosPackages = void(std::vector<std::string>& names);
constexpr const char* kNameRosPackages = "pliant_ros_packages";

}  // namespace pliant
