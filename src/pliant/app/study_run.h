#pragma once

#include "pliant/app/study_options.h"
#include "pliant/study/accuracy/accuracy_plan.h"
#include "pliant/study/study_folder.h"

namespace pliant {

/// Loads the scene to check it, prints its warnings, sets the threads. Throws InputError.
SceneSpec load_study_scene(const StudyOptions& options);

/// The folder of `options.out`, with what it holds already; in memory without one. Throws
/// InputError.
StudyFolder open_study_folder(const StudyOptions& options, const AccuracyPlan& plan);

/// Measures what `folder` lacks, with a progress bar; Ctrl-C stops it. Returns the exit code, and
/// says on stderr what is wrong when that is not 0.
int measure_study(const AccuracyPlan& plan, bool show_progress, StudyFolder& folder);

}  // namespace pliant
