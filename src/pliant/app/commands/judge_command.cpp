#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/plot.h"
#include "pliant/app/progress_bar.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/folder_lock.h"
#include "pliant/math/error.h"
#include "pliant/study/judges/judge_table.h"
#include "pliant/study/option_text.h"
#include "pliant/study/tables_folder.h"

namespace pliant {
namespace {

struct JudgeCommand {
  std::string names = "all";
  std::string folder;
  int threads = 1;
  bool progress = false;
  bool no_plot = false;
};

std::string judge_meanings() {
  std::string text = "Judges:\n";
  for (const Judge& judge : judges()) {
    text += fmt::format("  {:<21} {}\n", judge.name, judge.source);
  }
  return text +
         "  quick                 those that take about a second\n"
         "  all                   all of these\nMore in docs/validation.md.";
}

std::vector<const Judge*> chosen_judges(const std::string& text) {
  std::vector<const Judge*> chosen;
  std::vector<std::string> known = {"all", "quick"};
  for (const Judge& judge : judges()) {
    known.push_back(judge.name);
    if (text == "all" || (text == "quick" && judge.is_quick)) chosen.push_back(&judge);
  }
  if (!chosen.empty()) return chosen;
  for (const std::string& name : parse_names(text, "--judges")) {
    const auto found = std::find_if(judges().begin(), judges().end(),
                                    [&](const Judge& judge) { return judge.name == name; });
    if (found == judges().end()) throw InputError(unknown_name_message("judge", name, known));
    chosen.push_back(&*found);
  }
  return chosen;
}

void print_and_write(const std::vector<JudgedRow>& rows, const JudgeCommand& command) {
  const auto misses =
      std::count_if(rows.begin(), rows.end(), [](const JudgedRow& row) { return row.is_miss(); });
  fmt::print("{}\n{}\n{} figures, {} misses\n", judge_table(rows), judge_sources(rows), rows.size(),
             misses);
  if (command.folder.empty()) return;
  write_file_atomically(command.folder + "/judges.csv", judge_csv(rows));
  const bool is_drawn = std::any_of(rows.begin(), rows.end(), [](const JudgedRow& row) {
    return row.judge->is_drawn && row.failure.empty();
  });
  const bool has_picture = !command.no_plot && is_drawn && plot_judges(command.folder);
  fmt::print("written: tables{} in {}\n", has_picture ? " and a picture" : "", command.folder);
}

int judge_all(const JudgeCommand& command) {
  const std::vector<const Judge*> chosen = chosen_judges(command.names);
  set_threads(command.threads);
  std::unique_ptr<FolderLock> lock;
  if (!command.folder.empty()) {
    claim_tables_folder(command.folder, "judge");
    lock = std::make_unique<FolderLock>(command.folder);
  }
  catch_interrupts();
  ProgressBar bar(command.progress || isatty(STDERR_FILENO) != 0);
  bool is_cut = false;
  const std::vector<JudgedRow> rows =
      run_judges(chosen, command.folder, [&](double done, const std::string& judge) {
        bar.update(done, 1.0, judge);
        is_cut = interrupted();
        return !is_cut;
      });
  bar.clear();
  if (!rows.empty()) print_and_write(rows, command);
  std::fflush(stdout);
  if (is_cut) {
    std::cerr << "interrupted: the table is of the judges that ended before\n";
    return kInterrupted;
  }
  const bool any_miss =
      std::any_of(rows.begin(), rows.end(), [](const JudgedRow& row) { return row.is_miss(); });
  return any_miss ? kNoAnswer : kOk;
}

}  // namespace

void add_judge_command(CLI::App& study, int& exit_code) {
  CLI::App* command = add_command(
      study, "judge", "Compare the library with published figures of solids, liquids and fabrics");
  command->footer(judge_meanings() + "\n\n" + command->get_footer());
  auto options = std::make_shared<JudgeCommand>();
  command->add_option("--judges", options->names, "Which ones, as hertz,torsion [all]")
      ->type_name("NAMES");
  command->add_option("--out", options->folder, "Folder for tables, curves and a picture")
      ->type_name("DIR");
  command->add_option("--threads", options->threads, "Threads a step may use [1]");
  command->add_flag("--no-plot", options->no_plot, "Draw no picture");
  command->add_flag("--progress", options->progress,
                    "Show the bar where stderr is no terminal too");
  command->callback([options, &exit_code] { exit_code = judge_all(*options); });
}

}  // namespace pliant
