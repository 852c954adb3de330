#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pliant/study/accuracy/accuracy_plan.h"
#include "pliant/study/accuracy/accuracy_row.h"
#include "pliant/study/accuracy/error_meter.h"
#include "pliant/study/accuracy/work_meter.h"

namespace pliant {

/// Errors of whole runs: each solver at each time step runs the scene from its start to the plan's
/// duration, and its end is compared with the reference's. So these errors contain those of the
/// discretisation in time. The reference comes from runs of the first reference solver at the
/// plan's reference time step h, of the second one at 2 h and of the first one at 4 h: the end is
/// extrapolated to time step 0 where that agrees better than the runs at h and 2 h do.
class RunStudy {
 public:
  /// `plan` must outlive this and have a reference time step.
  explicit RunStudy(const AccuracyPlan& plan);

  double preparation_work() const;
  double row_work(const PlannedRow& row) const;

  /// Runs the references. Needed before measure().
  StudyStatus prepare(WorkMeter& work);
  /// Empty when the work was stopped. A row does not depend on the rows measured before it.
  std::optional<AccuracyRow> measure(const PlannedRow& planned, WorkMeter& work);

  /// Relative position difference between two estimates of the end: extrapolated from h and 2 h and
  /// from 2 h and 4 h, or the runs at h and 2 h themselves.
  double disagreement() const { return disagreement_; }

 private:
  int steps_of(double time_step) const;
  /// Of the references.
  int order() const;
  std::unique_ptr<World> make_world(const SolverSetting& solver, double time_step) const;
  /// Runs a reference to its end.
  StudyStatus run(const std::string& name, double tolerance, double time_step, StateSample& end,
                  WorkMeter& work) const;
  void choose_reference(const StateSample& fine, const StateSample& middle,
                        const StateSample& coarse);

  const AccuracyPlan& plan_;
  std::unique_ptr<ErrorMeter> meter_;
  std::vector<Positions> start_;
  StateSample end_;  // of the reference
  ErrorScale scale_;
  double disagreement_ = 0.0;
};

}  // namespace pliant
