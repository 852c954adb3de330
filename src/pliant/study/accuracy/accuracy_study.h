#pragma once

#include "pliant/study/accuracy/accuracy_plan.h"
#include "pliant/study/accuracy/work_meter.h"
#include "pliant/study/study_folder.h"

namespace pliant {

/// Measures the rows of `plan` that `folder` does not have yet, in the plan's order, and adds each
/// to it. The listener hears of every step and can stop the study: the rows so far stay.
StudyStatus run_accuracy_study(const AccuracyPlan& plan, StudyFolder& folder,
                               const StudyListener& listener);

}  // namespace pliant
