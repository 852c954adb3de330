#include "pliant/study/run_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/core/step/time_integration.h"
#include "pliant/scene/scene.h"
#include "pliant/study/accuracy/reference_solvers.h"
#include "pliant/study/accuracy/sample_result.h"
#include "pliant/study/step_times.h"

namespace pliant {
namespace {

// Discretisation in time is so much coarser that more would be wasted.
constexpr double kReferenceTolerance = 1e-8;
constexpr double kSecondTolerance = 1e-6;
// Iterations of an ordinary solver that a reference's step may cost.
constexpr double kReferenceWork = 300.0;
// Of references of second order.
const char* const kReferenceIntegration = "bdf2";

}  // namespace

RunStudy::RunStudy(const AccuracyPlan& plan) : plan_(plan) {}

int RunStudy::steps_of(double time_step) const {
  return static_cast<int>(std::lround(plan_.duration / time_step));
}

double RunStudy::preparation_work() const {
  const double h = plan_.reference_time_step;
  return kReferenceWork * (steps_of(h) + steps_of(2.0 * h) + steps_of(4.0 * h));
}

double RunStudy::row_work(const PlannedRow& row) const {
  return (1.0 + row.solver.iterations) * steps_of(row.time_step);
}

std::unique_ptr<World> RunStudy::make_world(const SolverSetting& solver, double time_step) const {
  return build_world(scene_with(plan_.scene, solver, time_step));
}

int RunStudy::order() const {
  // One of first order would be no reference for those of second.
  const auto& names = plan_.options.time_integrations;
  const bool any = std::any_of(names.begin(), names.end(),
                               [](const std::string& name) { return name != kImplicitEuler; });
  return any ? 2 : 1;
}

StudyStatus RunStudy::run(const std::string& name, double tolerance, double time_step,
                          StateSample& end, WorkMeter& work) const {
  SolverSetting setting = reference_setting(plan_.scene, name, tolerance);
  if (order() == 2) setting.time_integration = kReferenceIntegration;
  const auto world = make_world(setting, time_step);
  const std::string what = fmt::format("{}: the whole run at {:g} s", name, time_step);
  for (int step = steps_of(time_step); step > 0; --step) {
    if (!world->step()) return StudyStatus::not_finite(world->failure());
    if (!work.add(kReferenceWork, what)) return StudyStatus::interrupted();
  }
  end = meter_->sample(*world);
  return {};
}

StudyStatus RunStudy::prepare(WorkMeter& work) {
  const double h = plan_.reference_time_step;
  const auto& names = plan_.options.references;
  const auto world = build_world(plan_.scene);
  meter_ = std::make_unique<ErrorMeter>(*world);
  start_ = meter_->sample(*world).positions;
  StateSample fine, middle, coarse;
  StudyStatus status = run(names[0], kReferenceTolerance, h, fine, work);
  if (status.is_done()) status = run(names[1], kSecondTolerance, 2.0 * h, middle, work);
  if (status.is_done()) status = run(names[0], kReferenceTolerance, 4.0 * h, coarse, work);
  if (status.is_done()) choose_reference(fine, middle, coarse);
  return status;
}

void RunStudy::choose_reference(const StateSample& fine, const StateSample& middle,
                                const StateSample& coarse) {
  const StateSample limit = extrapolated(fine, middle, order());
  const StateSample other_limit = extrapolated(middle, coarse, order());
  const bool extrapolate = meter_->distance(limit.positions, other_limit.positions) <
                           meter_->distance(fine.positions, middle.positions);
  end_ = extrapolate ? limit : fine;
  scale_ = meter_->scale(start_, end_);
  disagreement_ = meter_->errors(extrapolate ? other_limit : middle, end_, scale_).position;
}

std::optional<AccuracyRow> RunStudy::measure(const PlannedRow& planned, WorkMeter& work) {
  const auto world = make_world(planned.solver, planned.time_step);
  SampleResult result;
  result.prepare_seconds = set_solver(planned.solver, *world);
  StepTimes times;
  const int steps = steps_of(planned.time_step);
  for (int step = 0; step < steps && result.is_finite; ++step) {
    result.is_finite = times.step(*world);
    add_reports(*world, result);
    if (!work.add(1.0 + planned.solver.iterations, label(planned))) return std::nullopt;
  }
  result.errors =
      result.is_finite ? meter_->errors(meter_->sample(*world), end_, scale_) : infinite_errors();
  result.step_seconds = times.median();
  result.longest_seconds = times.longest();
  result.wall_seconds = times.median_wall();
  AccuracyRow row = summary(planned, {result});
  row.seconds_per_second = times.total() / (times.count() * planned.time_step);
  row.disagreement = disagreement_;
  return row;
}

}  // namespace pliant
