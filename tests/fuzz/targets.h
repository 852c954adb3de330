#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pliant {

/// One reader of files from elsewhere: whatever it is given, it returns or throws InputError.
struct FuzzTarget {
  std::string name;
  std::vector<std::string> seeds;  ///< small good files, to mutate
  /// Reads these bytes; returns whether they were accepted.
  std::function<bool(const std::string& bytes)> read;
};

/// All of them; tests run mutations of their seeds, scripts/fuzz lets libFuzzer find others.
const std::vector<FuzzTarget>& fuzz_targets();

}  // namespace pliant
