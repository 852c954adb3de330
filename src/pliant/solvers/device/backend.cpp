#include "pliant/solvers/device/backend.h"

#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/error.h"
#include "pliant/solvers/device/backend_choice.h"
#include "pliant/solvers/device/cuda_library.h"

namespace pliant {
namespace {

/// Runs on the GPU as long as that goes well.
class BackendSolver final : public Solver {
 public:
  BackendSolver(std::string backend, std::unique_ptr<Solver> cpu, MakeDeviceSolver make,
                int iterations, const DeviceIteration& iteration)
      : backend_(std::move(backend)),
        cpu_(std::move(cpu)),
        make_(std::move(make)),
        iterations_(iterations),
        iteration_(iteration) {}
  std::string_view name() const override { return cpu_->name(); }

  void prepare(System& system, double dt) override {
    try {
      if (!device_) device_ = make_(batch_);
      if (backend_ == "auto" && !is_faster(static_cast<const ProjectiveSystem&>(system))) {
        device_.reset();
      } else {
        device_->prepare(system, dt);
      }
    } catch (const InputError& error) {
      device_.reset();
      const std::string reason = error.what();
      if (is_new_ && backend_ == "cuda") {
        throw InputError("backend 'cuda': " + reason + "; use backend 'cpu' or 'auto'");
      }
      fall_back(reason);
    } catch (const DeviceFailure& failure) {
      fall_back(failure.what());
    }
    is_new_ = false;
    if (!device_) cpu_->prepare(system, dt);
    dt_ = dt;
  }

  void step(System& system, double dt, StepReport& report) override {
    begin_step(system, dt, report);
    finish_step(system, dt, report);
  }

  void begin_step(System& system, double dt, StepReport& report) override {
    report.backend_reason = choice_;
    running().begin_step(system, dt, report);
  }

  void finish_step(System& system, double dt, StepReport& report) override {
    if (device_) {
      try {
        device_->finish_step(system, dt, report);
        return;
      } catch (const DeviceFailure& failure) {
        fall_back(failure.what());
        system.undo_step();
        report.begin_substep();
        report.backend_reason = choice_;
        cpu_->prepare(system, dt_);
        cpu_->begin_step(system, dt, report);
      }
    }
    cpu_->finish_step(system, dt, report);
    if (!warning_.empty()) report.warn(std::exchange(warning_, {}));
  }

  int resident_limit(const System& system, const ResidentRun& run) override {
    return running().resident_limit(system, run);
  }
  void begin_resident_run(System& system, const ResidentRun& run, StepReport& report) override {
    report.backend_reason = choice_;
    running().begin_resident_run(system, run, report);
  }
  int finish_resident_run(System& system, std::vector<Reaction>& reactions,
                          StepReport& report) override {
    try {
      return running().finish_resident_run(system, reactions, report);
    } catch (const DeviceFailure& failure) {
      fall_back(failure.what());
      cpu_->prepare(system, dt_);
      return 0;
    }
  }
  Readback available() const override { return running().available(); }
  const Positions* seen_surface() const override { return running().seen_surface(); }
  bool read_back_state(System& system) override {
    try {
      return running().read_back_state(system);
    } catch (const DeviceFailure& failure) {
      fall_back(failure.what());
      cpu_->prepare(system, dt_);
      return false;
    }
  }

  bool join(SolverBatch& batch) override {
    batch_ = &batch;
    device_.reset();
    return true;
  }

  bool runs_on_gpu() const override { return device_ != nullptr; }
  Solver& on_cpu() override { return *cpu_; }

  void save(StateArchive& numbers) const override { running().save(numbers); }
  void load(StateArchive& numbers) override { running().load(numbers); }

 private:
  const Solver& running() const { return device_ ? *device_ : *cpu_; }
  Solver& running() { return device_ ? *device_ : *cpu_; }
  /// In a batch one launch serves all its scenes: what a scene alone takes says nothing.
  bool is_faster(const ProjectiveSystem& system) {
    const BackendEstimate estimate = estimate_step(system, iterations_, threads(), iteration_);
    const bool is_shared = batch_ != nullptr;
    choice_ = is_shared ? "one launch for all scenes" : why_faster(estimate);
    return is_shared || estimate.cuda < estimate.cpu;
  }
  void fall_back(const std::string& reason) {
    device_.reset();
    if (backend_ == "auto") choice_ = reason;
    if (reason == reason_) return;
    reason_ = reason;
    if (backend_ == "cuda") warning_ = "backend_cpu: not on the GPU, but on the CPU: " + reason;
  }

  std::string backend_;
  std::unique_ptr<Solver> cpu_, device_;
  MakeDeviceSolver make_;
  int iterations_;
  DeviceIteration iteration_;
  SolverBatch* batch_ = nullptr;
  bool is_new_ = true;
  double dt_ = 0.0;
  std::string warning_, reason_, choice_;
};

}  // namespace

ParameterSpec backend_parameter() {
  return choice_parameter("backend", "cpu", {"auto", "cpu", "cuda"},
                          "where the iterations run; cuda: on a GPU, in single precision; auto: "
                          "there where there is one that can and is estimated to be faster");
}

std::unique_ptr<Solver> with_fallback(const std::string& backend, std::unique_ptr<Solver> cpu,
                                      MakeDeviceSolver make, int iterations,
                                      const DeviceIteration& iteration) {
  return std::make_unique<BackendSolver>(backend, std::move(cpu), std::move(make), iterations,
                                         iteration);
}

std::unique_ptr<Solver> make_on_backend(const std::string& backend, std::unique_ptr<Solver> cpu,
                                        const DeviceSolverSpec& spec) {
  if (backend == "cpu") return cpu;
  const auto make = [spec](SolverBatch* batch) -> std::unique_ptr<Solver> {
    const std::string reason = why_no_cuda();
    if (!reason.empty()) throw DeviceFailure(reason);
    std::unique_ptr<Solver> solver;
    cuda_function<MakeCudaSolver>(kMakeCudaSolver)(spec, batch, solver);
    return solver;
  };
  return with_fallback(backend, std::move(cpu), make, spec.rule.iterations, spec.iteration);
}

}  // namespace pliant
