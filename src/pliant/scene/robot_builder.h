#pragma once

#include <memory>
#include <string>

#include "pliant/scene/robot_data.h"

namespace pliant {

/// Robot::from_text() with `urdf_path` ("" for none), what relative mesh paths are relative to.
std::unique_ptr<Robot::Data> build_robot(const std::string& urdf, const std::string& urdf_path,
                                         const PackageResolver& resolver, const std::string& where);

/// The same without collision shapes.
std::unique_ptr<Robot::Data> build_kinematics(const std::string& urdf, const std::string& where);

}  // namespace pliant
