#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/study/accuracy/accuracy_plan.h"
#include "pliant/study/accuracy/accuracy_row.h"
#include "pliant/study/accuracy/error_meter.h"
#include "pliant/study/accuracy/sample_result.h"
#include "pliant/study/accuracy/work_meter.h"

namespace pliant {

/// Errors of single time steps: a solver close to convergence runs the scene; from states of
/// it, each solver makes the one step that follows, and is compared with the converged one.
class StepStudy {
 public:
  /// `plan` must outlive this.
  explicit StepStudy(const AccuracyPlan& plan) : plan_(plan) {}

  /// Work of prepare() and of measure() for one row, as WorkMeter counts it.
  double preparation_work() const;
  double row_work(const PlannedRow& row) const;

  /// Runs the scene and finds the converged steps. Needed before measure().
  StudyStatus prepare(WorkMeter& work);
  /// Empty when the work was stopped. A row does not depend on the rows measured before it.
  std::optional<AccuracyRow> measure(const PlannedRow& planned, WorkMeter& work);

  /// Relative position error between the two references, the largest over the samples that count.
  double disagreement() const { return disagreement_; }

 private:
  struct Sample {
    Checkpoint start;
    StateSample converged;
    ErrorScale scale;
    double disagreement = 0.0;  // of the references
  };
  /// Takes the scene through the samples' states.
  StudyStatus run_scene(WorkMeter& work);
  /// Makes each sample's step with a reference; use(sample) then looks at the world.
  template <class Use>
  StudyStatus step_samples(const std::string& reference, double tolerance, WorkMeter& work,
                           const Use& use);
  /// Leaves out the samples on whose step the references disagree, unless that is most of them.
  void drop_ambiguous_samples();
  double sample_work(const PlannedRow& row) const;
  void take_result(const Sample& sample, SampleResult& result) const;
  std::optional<SampleResult> measure_sample(const Sample& sample, const PlannedRow& planned,
                                             WorkMeter& work);

  const AccuracyPlan& plan_;
  std::unique_ptr<World> world_;
  std::unique_ptr<ErrorMeter> meter_;
  std::vector<Sample> samples_;
  double disagreement_ = 0.0;
};

/// Relative position error between references above which a step has no solution to compare with:
/// one of them does not converge there, or it has more than one.
constexpr double kGoodAgreement = 1e-4;

/// Numbers of the steps before which the samples lie: the middles of `samples` equal parts.
std::vector<int> sample_steps(int steps, int samples);

}  // namespace pliant
