#include "pliant/study/step_study.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/scene/scene.h"
#include "pliant/study/accuracy/reference_solvers.h"
#include "pliant/study/step_times.h"

namespace pliant {
namespace {

constexpr double kStepReferenceTolerance = 1e-10;
constexpr double kStepSecondTolerance = 1e-12;
// What a converged step and one of the runner may cost, in iterations of an ordinary solver.
constexpr double kStepReferenceWork = 3000.0;
constexpr double kRunnerWork = 200.0;
constexpr double kLongEnough = 0.5;  // of timed repeats [s]

}  // namespace

std::vector<int> sample_steps(int steps, int samples) {
  std::vector<int> numbers;
  for (int k = 0; k < samples; ++k) {
    numbers.push_back(static_cast<int>((2LL * k + 1) * steps / (2LL * samples)));
  }
  return numbers;
}

double StepStudy::preparation_work() const {
  const std::vector<int> numbers = sample_steps(plan_.steps, plan_.options.samples);
  return numbers.back() * kRunnerWork + plan_.options.samples * 2.0 * kStepReferenceWork;
}

double StepStudy::row_work(const PlannedRow& row) const {
  return plan_.options.samples * sample_work(row);
}

double StepStudy::sample_work(const PlannedRow& row) const {
  return (plan_.options.repeats + 1.0) * (1.0 + row.solver.iterations);
}

StudyStatus StepStudy::prepare(WorkMeter& work) {
  StudyStatus status = run_scene(work);
  const auto& names = plan_.options.references;
  if (status.is_done()) {
    status = step_samples(names[0], kStepReferenceTolerance, work, [this](Sample& sample) {
      sample.converged = meter_->sample(*world_);
      sample.scale = meter_->scale(inertial_prediction(*world_), sample.converged);
    });
  }
  if (!status.is_done()) return status;
  status = step_samples(names[1], kStepSecondTolerance, work, [this](Sample& sample) {
    sample.disagreement =
        meter_->errors(meter_->sample(*world_), sample.converged, sample.scale).position;
  });
  if (status.is_done()) drop_ambiguous_samples();
  return status;
}

void StepStudy::drop_ambiguous_samples() {
  const auto is_clear = [](const Sample& sample) { return sample.disagreement <= kGoodAgreement; };
  const auto ambiguous = std::stable_partition(samples_.begin(), samples_.end(), is_clear);
  if (ambiguous - samples_.begin() >= samples_.end() - ambiguous) {
    samples_.erase(ambiguous, samples_.end());
  }
  disagreement_ = 0.0;
  for (const Sample& sample : samples_) {
    disagreement_ = std::max(disagreement_, sample.disagreement);
  }
}

StudyStatus StepStudy::run_scene(WorkMeter& work) {
  world_ = build_world(scene_with(plan_.scene, plan_.runner, plan_.scene.time_step));
  meter_ = std::make_unique<ErrorMeter>(*world_);
  samples_.clear();
  for (int number : sample_steps(plan_.steps, plan_.options.samples)) {
    while (world_->steps() < static_cast<std::uint64_t>(number)) {
      if (!world_->step()) return StudyStatus::not_finite(world_->failure());
      const std::string what =
          fmt::format("run by {}: step {}", plan_.runner.name, world_->steps());
      if (!work.add(kRunnerWork, what)) return StudyStatus::interrupted();
    }
    samples_.push_back({world_->save(), {}, {}});
  }
  return {};
}

template <class Use>
StudyStatus StepStudy::step_samples(const std::string& reference, double tolerance, WorkMeter& work,
                                    const Use& use) {
  set_solver(reference_setting(plan_.scene, reference, tolerance), *world_);
  for (Sample& sample : samples_) {
    world_->load(sample.start);
    if (!world_->step()) return StudyStatus::not_finite(world_->failure());
    use(sample);
    const std::string what = "converged steps by " + reference;
    if (!work.add(kStepReferenceWork, what)) return StudyStatus::interrupted();
  }
  return {};
}

std::optional<SampleResult> StepStudy::measure_sample(const Sample& sample,
                                                      const PlannedRow& planned, WorkMeter& work) {
  SampleResult result;
  result.prepare_seconds = set_solver(planned.solver, *world_);
  StepTimes times;
  // The first step fills caches and estimates what the solver keeps; the second one is the result;
  // more of them, within reason, are for its time alone.
  for (int k = 0; k <= plan_.options.repeats && result.is_finite; ++k) {
    if (k > 1 && times.total_wall() > kLongEnough) break;
    world_->load(sample.start);
    result.is_finite = times.step(*world_, k > 0);
    if (k == 1) take_result(sample, result);
    if (!work.add(0.0, label(planned))) return std::nullopt;
  }
  if (!result.is_finite) result.errors = infinite_errors();
  result.step_seconds = result.longest_seconds = times.median();
  result.wall_seconds = times.median_wall();
  if (!work.add(sample_work(planned), label(planned))) return std::nullopt;
  return result;
}

void StepStudy::take_result(const Sample& sample, SampleResult& result) const {
  result.errors = meter_->errors(meter_->sample(*world_), sample.converged, sample.scale);
  add_reports(*world_, result);
}

std::optional<AccuracyRow> StepStudy::measure(const PlannedRow& planned, WorkMeter& work) {
  std::vector<SampleResult> results;
  for (const Sample& sample : samples_) {
    const auto result = measure_sample(sample, planned, work);
    if (!result) return std::nullopt;
    results.push_back(*result);
  }
  AccuracyRow row = summary(planned, results);
  row.disagreement = disagreement_;
  return row;
}

}  // namespace pliant
