#pragma once

#include <string>

namespace pliant {

/// Where in the user's files something was written.
struct SourcePlace {
  std::string file;
  int line = 0;  ///< from 1

  /// "FILE:LINE", as every message begins.
  std::string text() const { return file + ":" + std::to_string(line); }
};

}  // namespace pliant
