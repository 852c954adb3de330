#pragma once

#include <CLI/CLI.hpp>

namespace pliant {

enum ExitCode {
  kOk = 0,
  kInternalError = 1,
  kBadInput = 2,
  kNotFinite = 3,
  kNoAnswer = 4,
  kInterrupted = 130,
};

/// Each adds one subcommand to `app`. When the user calls it, it sets `exit_code`; it throws
/// InputError for bad input.
void add_check_command(CLI::App& app, int& exit_code);
void add_run_command(CLI::App& app, int& exit_code);
void add_list_command(CLI::App& app, int& exit_code);
void add_describe_command(CLI::App& app, int& exit_code);
void add_collider_command(CLI::App& app, int& exit_code);
void add_fit_command(CLI::App& app, int& exit_code);
void add_study_command(CLI::App& app, int& exit_code);
void add_reduce_command(CLI::App& app, int& exit_code);
/// These belong to the command `study`.
void add_accuracy_command(CLI::App& study, int& exit_code);
void add_advise_command(CLI::App& study, int& exit_code);
void add_reduced_command(CLI::App& study, int& exit_code);
void add_viscoelastic_command(CLI::App& study, int& exit_code);
void add_cloth_command(CLI::App& study, int& exit_code);
void add_stability_command(CLI::App& study, int& exit_code);
void add_judge_command(CLI::App& study, int& exit_code);

/// A subcommand with what all have: --version, and the exit codes in --help.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description);

}  // namespace pliant
