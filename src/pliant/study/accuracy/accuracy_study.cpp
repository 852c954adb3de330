#include "pliant/study/accuracy/accuracy_study.h"

#include <algorithm>

#include "pliant/study/accuracy/sample_result.h"
#include "pliant/study/run_study.h"
#include "pliant/study/step_study.h"

namespace pliant {
namespace {

bool is_row_of(const AccuracyRow& row, const PlannedRow& planned) {
  return row.measure == planned.measure && row.solver == planned.solver.name &&
         row.time_integration == planned.time_integration &&
         row.iterations == planned.solver.iterations && row.time_step == planned.time_step;
}

/// The plan's rows of one measure that are not there yet.
std::vector<PlannedRow> missing_rows(const AccuracyPlan& plan, const StudyFolder& folder,
                                     Measure measure) {
  std::vector<PlannedRow> missing;
  for (const PlannedRow& planned : plan.rows) {
    const auto is_it = [&](const AccuracyRow& row) { return is_row_of(row, planned); };
    const bool is_there = std::any_of(folder.rows().begin(), folder.rows().end(), is_it);
    if (planned.measure == measure && !is_there) missing.push_back(planned);
  }
  return missing;
}

/// The row, if one with fewer iterations says it already.
std::optional<AccuracyRow> known_row(const PlannedRow& planned, const StudyFolder& folder) {
  for (AccuracyRow row : folder.rows()) {
    const bool fewer = row.is_converged() && row.iterations < planned.solver.iterations;
    row.iterations = planned.solver.iterations;
    if (fewer && is_row_of(row, planned)) return row;
  }
  return std::nullopt;
}

template <class Study>
void expect_work(const Study& study, const std::vector<PlannedRow>& rows, WorkMeter& work) {
  if (rows.empty()) return;
  work.expect(study.preparation_work());
  for (const PlannedRow& row : rows) work.expect(study.row_work(row));
}

template <class Study>
StudyStatus measure_rows(Study& study, const std::vector<PlannedRow>& rows, StudyFolder& folder,
                         WorkMeter& work) {
  if (rows.empty()) return {};
  const StudyStatus status = study.prepare(work);
  if (!status.is_done()) return status;
  for (const PlannedRow& planned : rows) {
    auto row = known_row(planned, folder);
    if (row && !work.add(study.row_work(planned), label(planned)))
      return StudyStatus::interrupted();
    if (!row) row = study.measure(planned, work);
    if (!row) return StudyStatus::interrupted();
    folder.add(*row);
  }
  return {};
}

}  // namespace

StudyStatus run_accuracy_study(const AccuracyPlan& plan, StudyFolder& folder,
                               const StudyListener& listener) {
  WorkMeter work(listener);
  const auto step_rows = missing_rows(plan, folder, Measure::kStep);
  const auto run_rows = missing_rows(plan, folder, Measure::kRun);
  StepStudy steps(plan);
  RunStudy runs(plan);
  expect_work(steps, step_rows, work);
  expect_work(runs, run_rows, work);
  const StudyStatus status = measure_rows(steps, step_rows, folder, work);
  return status.is_done() ? measure_rows(runs, run_rows, folder, work) : status;
}

}  // namespace pliant
