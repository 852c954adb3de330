#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "pliant/scene/batch.h"

namespace pliant {

/// What is written of a scene when it is finished.
struct SceneText {
  std::string rows, contacts;
  std::set<std::string> warnings;  ///< of its steps
};

/// A group of scenes amid their steps.
struct UnfinishedGroup {
  std::uint64_t steps = 0;       ///< that were taken
  std::vector<SceneText> texts;  ///< of each scene so far
  std::vector<std::string>
      states;  ///< of each, as a file holds it (checkpoint_file.h); "": refused
};

/// As bytes of a file.
std::string bytes_of(std::uint64_t steps, const std::vector<SceneText>& texts, const Batch& batch);
/// Back. Throws InputError "WHERE: ..." for bytes that are damaged.
UnfinishedGroup unfinished_group(const std::string& bytes, const std::string& where);
/// Puts the scenes of `batch` to where they were. Throws InputError.
void restore(const UnfinishedGroup& group, const std::string& where, Batch& batch);

}  // namespace pliant
