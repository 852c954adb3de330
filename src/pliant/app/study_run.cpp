#include "pliant/app/study_run.h"

#include <fmt/format.h>

#include <iostream>

#include "pliant/app/commands/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/progress_bar.h"
#include "pliant/math/error.h"
#include "pliant/study/accuracy/accuracy_study.h"
#include "pliant/study/study_settings.h"

namespace pliant {

SceneSpec load_study_scene(const StudyOptions& options) {
  if (options.overwrite && options.out.empty()) {
    throw InputError("--overwrite needs --out DIR: nothing is written without it");
  }
  return load_scene(options.scene).spec;
}

StudyFolder open_study_folder(const StudyOptions& options, const AccuracyPlan& plan) {
  if (options.out.empty()) return {};
  return {options.out, settings_text(plan), options.overwrite};
}

int measure_study(const AccuracyPlan& plan, bool show_progress, StudyFolder& folder) {
  catch_interrupts();
  ProgressBar bar(show_progress);
  const StudyStatus status =
      run_accuracy_study(plan, folder, [&bar](double done, double total, const std::string& what) {
        bar.update(done, total, what);
        return !interrupted();
      });
  bar.clear();
  if (status.end == StudyStatus::End::kNotFinite) {
    std::cerr << "error: the reference: " << status.message
              << " Or name others with --references.\n";
    return kNotFinite;
  }
  if (status.is_done()) return kOk;
  std::cerr << fmt::format(
      "interrupted with {} of {} rows measured{}\n", folder.rows().size(), plan.rows.size(),
      folder.directory().empty()
          ? ""
          : "; they are in " + folder.table_path() + ", and the same command goes on from there");
  return kInterrupted;
}

}  // namespace pliant
