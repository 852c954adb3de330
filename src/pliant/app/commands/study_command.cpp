#include <iostream>

#include "pliant/app/commands/commands.h"

namespace pliant {

void add_study_command(CLI::App& app, int& exit_code) {
  CLI::App* study =
      add_command(app, "study", "Studies of accuracy, and advice that comes from them");
  study->require_subcommand(0, 1);  // 1 would hide which word is no study
  add_accuracy_command(*study, exit_code);
  add_advise_command(*study, exit_code);
  add_reduced_command(*study, exit_code);
  add_viscoelastic_command(*study, exit_code);
  add_cloth_command(*study, exit_code);
  add_stability_command(*study, exit_code);
  add_judge_command(*study, exit_code);
  study->callback([study, &exit_code] {
    if (!study->get_subcommands().empty()) return;
    std::cerr << study->help();
    exit_code = kBadInput;
  });
}

}  // namespace pliant
