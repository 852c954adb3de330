#pragma once

#include <memory>
#include <string>

#include "pliant/scene/robot/robot_data.h"

namespace pliant {

/// Robot::from_text() with `urdf_path` ("" for none), what relative mesh paths are relative to.
std::unique_ptr<Robot::Data> build_robot(const std::string& urdf, const std::string& urdf_path,
                                         const RobotOptions& options, const std::string& where);

}  // namespace pliant
