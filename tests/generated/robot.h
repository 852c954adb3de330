#pragma once

#include <string>

namespace pliant {

/// The robot of generated scenes.
inline std::string finger_path() {
  return std::string(PLIANT_SOURCE_DIR) + "/config/robots/finger.urdf";
}

}  // namespace pliant
