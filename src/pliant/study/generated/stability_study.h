#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pliant/study/generated/generated_oracles.h"

namespace pliant {

/// A study of generated scenes: how every one of them fares.
struct StabilityOptions {
  std::string folder;  ///< it exists: scenes.csv, stability.md and the scenes that failed go there
  int scenes = 20000;
  std::uint64_t seed = 1;
  int jobs = 1;       ///< processes at a time
  std::string robot;  ///< path of finger.urdf
};

struct TriedScene {
  SceneChoice choice;
  SceneOutcome outcome;
};

/// Told how many scenes are done; false asks to stop.
using StabilityProgress = std::function<bool(int done, int of)>;

/// Those that were tried, also when it was asked to stop; then none that failed is written. Throws
/// InputError where a file cannot be written.
std::vector<TriedScene> study_stability(const StabilityOptions& options,
                                        const StabilityProgress& progress);

/// The table of case x solver x model, and one of energy and time, as Markdown.
std::string stability_tables(const std::vector<TriedScene>& scenes);
/// The scenes that failed, one of each oracle, solver and model, as the corpus holds them: shrunk.
std::string corpus_text(const SceneChoice& choice, const SceneOutcome& outcome);

}  // namespace pliant
