#include "pliant/study/step_study.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/scene/scene.h"
#include "pliant/study/reference_solvers.h"
#include "pliant/study/step_times.h"

namespace pliant {
namespace {

constexpr double kReferenceTolerance = 1e-10;
constexpr double kSecondTolerance = 1e-12;
// Iterations of an ordinary solver that a converged step may cost.
constexpr double kReferenceWork = 300.0;
constexpr double kSecondWork = 5000.0;

}  // namespace

std::vector<int> sample_steps(int steps, int samples) {
  std::vector<int> numbers;
  for (int k = 0; k < samples; ++k) {
    numbers.push_back(static_cast<int>((2LL * k + 1) * steps / (2LL * samples)));
  }
  return numbers;
}

double StepStudy::preparation_work() const {
  return plan_.steps * kReferenceWork + plan_.options.samples * kSecondWork;
}

double StepStudy::row_work(const PlannedRow& row) const {
  return plan_.options.samples * (plan_.options.repeats + 1.0) * (1.0 + row.solver.iterations);
}

StudyStatus StepStudy::prepare(WorkMeter& work) {
  StudyStatus status = run_reference(work);
  return status.is_done() ? compare_references(work) : status;
}

StudyStatus StepStudy::run_reference(WorkMeter& work) {
  const SolverSetting reference =
      reference_setting(plan_.scene, plan_.options.references[0], kReferenceTolerance);
  world_ = build_world(scene_with(plan_.scene, reference, plan_.scene.time_step));
  meter_ = std::make_unique<ErrorMeter>(*world_);
  const std::vector<int> numbers = sample_steps(plan_.steps, plan_.options.samples);
  samples_.clear();
  for (int step = 0; step <= numbers.back(); ++step) {
    const bool is_sample = std::binary_search(numbers.begin(), numbers.end(), step);
    if (is_sample) samples_.push_back({world_->save(), {}, {}});
    if (!world_->step()) return StudyStatus::not_finite(world_->failure());
    if (is_sample) {
      samples_.back().converged = meter_->sample(*world_);
      samples_.back().scale =
          meter_->scale(inertial_prediction(*world_), samples_.back().converged);
    }
    const std::string what = fmt::format("{}: step {}", reference.name, step + 1);
    if (!work.add(kReferenceWork, what)) return StudyStatus::interrupted();
  }
  return {};
}

StudyStatus StepStudy::compare_references(WorkMeter& work) {
  const SolverSetting second =
      reference_setting(plan_.scene, plan_.options.references[1], kSecondTolerance);
  disagreement_ = 0.0;
  set_solver(second, *world_);
  for (Sample& sample : samples_) {
    world_->load(sample.start);
    if (!world_->step()) return StudyStatus::not_finite(world_->failure());
    const Errors errors = meter_->errors(meter_->sample(*world_), sample.converged, sample.scale);
    disagreement_ = std::max(disagreement_, errors.position);
    const std::string what = fmt::format("{}: the same steps for comparison", second.name);
    if (!work.add(kSecondWork, what)) return StudyStatus::interrupted();
  }
  return {};
}

std::optional<SampleResult> StepStudy::measure_sample(const Sample& sample,
                                                      const PlannedRow& planned, WorkMeter& work) {
  SampleResult result;
  StepTimes times;
  // The first one fills caches and is not timed.
  for (int k = 0; k <= plan_.options.repeats; ++k) {
    world_->load(sample.start);
    result.is_finite = times.step(*world_, k > 0);
    if (!work.add(1.0 + planned.solver.iterations, label(planned))) return std::nullopt;
    if (!result.is_finite) break;
  }
  result.errors = result.is_finite
                      ? meter_->errors(meter_->sample(*world_), sample.converged, sample.scale)
                      : infinite_errors();
  add_reports(*world_, result);
  result.step_seconds = result.longest_seconds = times.median_wall();
  result.processor_seconds = times.median_processor();
  return result;
}

std::optional<AccuracyRow> StepStudy::measure(const PlannedRow& planned, WorkMeter& work) {
  const double prepare_seconds = set_solver(planned.solver, *world_);
  std::vector<SampleResult> results;
  for (const Sample& sample : samples_) {
    const auto result = measure_sample(sample, planned, work);
    if (!result) return std::nullopt;
    results.push_back(*result);
  }
  AccuracyRow row = summary(planned, results);
  row.prepare_seconds = prepare_seconds;
  row.disagreement = disagreement_;
  return row;
}

}  // namespace pliant
