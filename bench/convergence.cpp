// Iterations and time that each solver needs to bring the error of one implicit Euler step down by
// given factors: |x - x*| / |y - x*| in the norm of the masses, y the prediction, x* Newton's
// answer.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>

#include "convergence_scenes.h"
#include "pliant/solvers/registry.h"

namespace pliant::bench {
namespace {

constexpr int kRepeats = 3;

struct Cost {
  int iterations = 0;
  double milliseconds = 0.0;
};

/// One step, always from the same state.
class StepProblem {
 public:
  explicit StepProblem(const ConvergenceScene& scene) : world_(scene.make()) {
    body().initial = body().particles();
    world_->set_initial_state();
    set_solver("newton", 100);
    for (int k = 0; k < scene.settling_steps; ++k) world_->step();
    state_ = body().particles();
    step("newton", 100);
    exact_ = body().particles().x;
    residual_ = body().report.residual;
    step("jacobi", 0);
    first_error_ = distance();
  }

  double residual() const { return residual_; }
  int vertices() const { return state_.size(); }

  void set_solver(const std::string& name, int iterations) {
    ParameterText parameters = {{"iterations", std::to_string(iterations)}};
    if (name == "newton") parameters["tolerance"] = "1e-12";
    world_->set_solver(body(), solver_registry(), name, parameters, "bench");
  }

  /// Relative error after the step.
  double step(const std::string& name, int iterations) {
    set_solver(name, iterations);
    // What a running simulation has learned by then (the spectral radius) is learned first.
    const int warm = name == "chebyshev" ? 3 : 0;
    for (int k = 0; k < warm; ++k) step_again();
    step_again();
    return distance() / first_error_;
  }

  double milliseconds() {
    double best = 1e3 * body().report.seconds;
    for (int k = 1; k < kRepeats; ++k) {
      step_again();
      best = std::min(best, 1e3 * body().report.seconds);
    }
    return best;
  }

 private:
  Body& body() { return world_->bodies().front(); }
  void step_again() {
    body().particles() = state_;
    world_->step();
  }
  double distance() {
    double sum = 0.0;
    const Particles& p = body().particles();
    for (int i = 0; i < p.size(); ++i) {
      if (exact_.size() > 0) sum += p.mass[i] * (p.x.col(i) - exact_.col(i)).squaredNorm();
    }
    return std::sqrt(sum);
  }

  std::unique_ptr<World> world_;
  Particles state_;
  Positions exact_;
  double residual_ = 0.0;
  double first_error_ = 1.0;
};

/// The fewest iterations that reach `error`, by doubling, then halving the interval.
std::optional<Cost> cost_to(StepProblem& problem, const std::string& solver, double error,
                            int most_iterations) {
  int high = 1;
  while (problem.step(solver, high) > error) {
    high *= 2;
    if (high > most_iterations) return std::nullopt;
  }
  int low = high / 2;
  while (high - low > std::max(1, high / 20)) {
    const int middle = (low + high) / 2;
    (problem.step(solver, middle) > error ? low : high) = middle;
  }
  problem.step(solver, high);
  return Cost{high, problem.milliseconds()};
}

void run(const std::vector<std::string>& solvers, const std::vector<double>& errors,
         const std::string& only, int most_iterations) {
  fmt::print("scene,vertices,solver,error,iterations,milliseconds\n");
  for (const ConvergenceScene& scene : convergence_scenes()) {
    if (scene.name.find(only) == std::string::npos) continue;
    StepProblem problem(scene);
    if (problem.residual() > 1e-8) {
      fmt::print(stderr, "{}: the reference did not converge: residual {}\n", scene.name,
                 problem.residual());
    }
    for (const std::string& solver : solvers) {
      for (const double error : errors) {
        const auto cost = cost_to(problem, solver, error, most_iterations);
        fmt::print("\"{}\",{},{},{:g},", scene.name, problem.vertices(), solver, error);
        if (cost) {
          fmt::print("{},{:.3f}\n", cost->iterations, cost->milliseconds);
        } else {
          fmt::print(",\n");
          break;
        }
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace
}  // namespace pliant::bench

int main(int argc, char** argv) {
  CLI::App app("Iterations and time of each solver to a given error of one step, as CSV");
  std::vector<std::string> solvers = {
      "jacobi", "line_search_jacobi", "chebyshev", "gauss_seidel", "hybrid", "direct", "lbfgs",
      "newton"};
  std::vector<double> errors = {1e-1, 1e-2, 1e-3, 1e-4};
  std::string only;
  app.add_option("--solvers", solvers)->delimiter(',');
  app.add_option("--errors", errors, "falling")->delimiter(',');
  app.add_option("--scene", only, "part of a scene's name");
  int most_iterations = 16384;
  app.add_option("--most", most_iterations, "iterations beyond which a solver gives up");
  CLI11_PARSE(app, argc, argv);
  pliant::bench::run(solvers, errors, only, most_iterations);
}
