// Solvers of which no iteration may raise the step's objective, whatever the problem.
#include <gtest/gtest.h>

#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

using Choice = std::tuple<StepProblem, std::string>;

class Descent : public testing::TestWithParam<Choice> {};
INSTANTIATE_TEST_SUITE_P(Problems, Descent,
                         testing::Combine(testing::ValuesIn(step_problems()),
                                          testing::Values("jacobi", "line_search_jacobi",
                                                          "gauss_seidel", "hybrid", "direct",
                                                          "lbfgs", "newton")),
                         [](const testing::TestParamInfo<Choice>& info) {
                           return std::get<0>(info.param).name + "_" + std::get<1>(info.param);
                         });

/// Round-off of the objective: of its sum, and of the lengths that are subtracted in it.
double round_off(const ProjectiveSystem& system, double dt, double value) {
  const Particles& p = system.particles;
  AbsoluteRowSums rows(p.size());
  for (const auto& set : system.elements) set->add_to_system(rows);
  const double stiffness = (rows.sums() + p.mass / (dt * dt)).maxCoeff();
  const double off = 4e-16 * p.x.cwiseAbs().maxCoeff();
  return 1e-14 * value + std::sqrt(2.0 * stiffness * value) * off * std::sqrt(p.size());
}

TEST_P(Descent, NoIterationRaisesTheObjective) {
  const auto& [problem, solver] = GetParam();
  for (const double dt : {problem.dt, 20 * problem.dt}) {
    const StepProblem step{problem.name, problem.make, dt};
    double last = objective_after(after_step(step, solver, iterations(0)), dt);
    const double first = last;
    for (const int count : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 20, 50, 200}) {
      // A few colours, so that hybrid has an overflow.
      ParameterText parameters = iterations(count);
      if (solver == "hybrid") parameters["colors"] = "2";
      ProjectiveSystem system = step.make();
      const StepReport report = step_of(system, solver, parameters, dt);
      const double value = objective_after(system, dt);
      EXPECT_LE(value, last + round_off(system, dt, last)) << dt << " s, " << count;
      // A step that gained energy was taken again until it converged: more iterations than asked.
      if (report.iterations <= count) last = value;
    }
    EXPECT_LT(last, first);
  }
}

}  // namespace
}  // namespace pliant
