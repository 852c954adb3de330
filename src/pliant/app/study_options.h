#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "pliant/app/scene_options.h"
#include "pliant/study/accuracy/accuracy_options.h"

namespace pliant {

/// The arguments of the studies of accuracy, as they were written.
struct StudyOptions {
  SceneOptions scene;
  std::optional<std::string> solvers;
  std::optional<std::string> iterations;
  std::optional<std::string> time_steps;
  std::optional<std::string> time_integrations;
  std::optional<std::string> references;
  std::optional<double> steps;
  std::optional<double> duration;  ///< [s]
  std::optional<int> samples;
  std::optional<int> repeats;
  std::string out;
  bool overwrite = false;
  bool progress = false;

  bool shows_progress() const;
  /// Whether an argument says what to measure.
  bool says_what() const;
};

/// All but --dt.
void add_study_options(CLI::App& command, StudyOptions& options);

/// `defaults` with what the arguments say. Throws InputError.
AccuracyOptions accuracy_options(const StudyOptions& options, AccuracyOptions defaults);

}  // namespace pliant
