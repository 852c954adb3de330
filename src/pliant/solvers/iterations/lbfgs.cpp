#include "pliant/solvers/iterations/lbfgs.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pliant/solvers/linear/multigrid.h"

namespace pliant {
namespace {
constexpr int kMostOnDevice = DeviceIteration::kMostHistory;
}  // namespace

LbfgsSolver::LbfgsSolver(const StopRule& rule, int history)
    : FactoredSolver(rule, ErrorControl::By::kTightTolerance), pairs_(history) {}

void LbfgsSolver::prepare_iterations(const ProjectiveSystem& system) {
  FactoredSolver::prepare_iterations(system);
  cholesky_.factor(matrix());
  prepare_touched(cholesky_.nonzeros());
}

void LbfgsSolver::begin_iterations(ProjectiveSystem& system, StepReport& report) {
  FactoredSolver::begin_iterations(system, report);
  pairs_.clear();
  has_last_ = is_plain_ = false;
  halved_steps_ = 0;
}

void LbfgsSolver::remember(const ProjectiveSystem& system) {
  const Positions& x = system.particles.x;
  if (has_last_) {
    QuasiNewtonPairs::Pair& pair = pairs_.next();
    pair.s = x - last_x_;
    pair.y = last_forces_ - forces();
    // What others did says nothing of the objective.
    for (const auto& [begin, end] : system.moved_by_others) {
      pair.s.middleCols(begin, end - begin).setZero();
      pair.y.middleCols(begin, end - begin).setZero();
    }
    pairs_.add_next();
  }
  last_x_ = x;
  last_forces_ = forces();
  has_last_ = true;
}

bool LbfgsSolver::begin_anew() {
  pairs_.clear();
  has_last_ = false;
  return !std::exchange(is_plain_, true);
}

bool LbfgsSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  if (finds_multipliers(system) && goes_astray(system, report) && !begin_anew()) return false;
  if (!is_plain_) remember(system);
  const auto p = [this](Eigen::Matrix3Xd& v) {
    multiply(matrix(), v, product_);
    v.swap(product_);
  };
  const auto p_inverse = [this](Eigen::Matrix3Xd& v) {
    pairs_.apply([this](Eigen::Matrix3Xd& b) { cholesky_.solve(b); }, v);
  };
  if (finds_multipliers(system)) {
    const double step = correct(system, p_inverse, report);
    if (step < 1.0) ++halved_steps_;
    if (step == 0.0) pairs_.clear();
    return true;
  }
  if (!begin_correction(system, report)) return true;
  {
    ScopedPhase phase(report, "global");
    equality_constrained().solve(rows(), system.particles, p, p_inverse, correction());
  }
  double step;
  {
    ScopedPhase phase(report, "line_search");
    step = search(system, last_x_);
  }
  if (step < 1.0) ++halved_steps_;
  if (step == 0.0) pairs_.clear();  // the next one is a plain projective step, which cannot fail
  end_correction(system, report);
  return true;
}

void LbfgsSolver::end_iterations(ProjectiveSystem& system, StepReport& report) {
  FactoredSolver::end_iterations(system, report);
  report.add_metric("factor_nonzeros", static_cast<double>(cholesky_.nonzeros()));
  report.add_metric("halved_steps", halved_steps_);
}

DeviceSolverSpec lbfgs_device_spec(const StopRule& rule, int history) {
  DeviceSolverSpec spec = lbfgs_device_spec(rule, history, Smoother::kSweeps);
  spec.iteration.is_multigrid = true;
  return spec;
}

DeviceSolverSpec lbfgs_device_spec(const StopRule& rule, int history, int sweeps) {
  DeviceSolverSpec spec = {"lbfgs", rule};
  spec.iteration.kind = DeviceIteration::kQuasiNewton;
  spec.iteration.history = std::min(history, kMostOnDevice);
  spec.iteration.sweeps = sweeps;
  if (history > kMostOnDevice) {
    spec.cpu_only = fmt::format("a 'history' of more than {} is for the CPU only", kMostOnDevice);
  }
  return spec;
}

SolverRegistry::Entry lbfgs_entry() {
  std::vector<ParameterSpec> parameters = stop_rule_parameters("10");
  for (ParameterSpec& parameter : parameters) {
    if (parameter.name != "error") continue;
    parameter.meaning =
        "adapt 'tolerance', and 'iterations' where these do not reach it, from step to step so "
        "that the estimated distance from where the body should be stays below this share of its "
        "displacement; on the CPU; 0 keeps them";
  }
  parameters.push_back(
      integer_parameter("history", "5", 1, 50,
                        fmt::format("earlier iterations that shape the next one; on a GPU {} at "
                                    "the most",
                                    kMostOnDevice)));
  parameters.push_back(backend_parameter());
  parameters.push_back(choice_parameter(
      "inverse", "auto", {"auto", "multigrid", "chebyshev"},
      "on a GPU: what stands for the solution with the factor, a multigrid cycle or 'sweeps' of a "
      "Chebyshev iteration; auto: the cycle for sheets, sweeps for solids"));
  parameters.push_back(integer_parameter(
      "sweeps", "16", 1, DeviceIteration::kMostSweeps,
      "on a GPU, without multigrid: more of them save iterations of stiff and of large "
      "bodies"));
  return {"lbfgs",
          "quasi-Newton on the factor of direct: as cheap an iteration, far fewer of them when the "
          "answer has to be exact",
          parameters, deformable_models(), [](const Parameters& given) {
            const StopRule rule = stop_rule(given);
            const int history = given.integer("history");
            const int sweeps = given.integer("sweeps");
            const std::string& inverse = given.text("inverse");
            DeviceSolverSpec spec = inverse == "chebyshev"
                                        ? lbfgs_device_spec(rule, history, sweeps)
                                        : lbfgs_device_spec(rule, history);
            if (inverse == "auto") spec.iteration.solid_sweeps = sweeps;
            return make_on_backend(given.text("backend"),
                                   std::make_unique<LbfgsSolver>(rule, history), spec);
          }};
}

}  // namespace pliant
