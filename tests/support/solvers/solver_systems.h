#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "pliant/core/system/system.h"
#include "pliant/elements/solids/elastic_material.h"
#include "pliant/geometry/mesh/triangle_mesh.h"
#include "support/worlds/worlds.h"

namespace pliant {

/// A bare system in motion, before a step of length `dt`: what solvers are tested on.
struct StepProblem {
  std::string name;
  std::function<ProjectiveSystem()> make;
  double dt = 0.005;  ///< [s]
};

inline std::ostream& operator<<(std::ostream& out, const StepProblem& problem) {
  return out << problem.name;
}

std::unique_ptr<Solver> make_solver(const std::string& name, const ParameterText& parameters = {});

/// One step with external forces as they are in the system.
StepReport step_of(ProjectiveSystem& system, Solver& solver, double dt);

/// The same for a solver that is made for this step.
StepReport step_of(ProjectiveSystem& system, const std::string& solver,
                   const ParameterText& parameters, double dt);

ProjectiveSystem after_step(const StepProblem& problem, const std::string& solver,
                            const ParameterText& parameters);

inline ParameterText iterations(int count) { return {{"iterations", std::to_string(count)}}; }

/// The solution of the step to round-off.
inline ProjectiveSystem after_converged_step(const StepProblem& problem) {
  return after_step(problem, "newton", {{"iterations", "300"}, {"tolerance", "1e-13"}});
}

/// y of the step that ended, where nothing but inertia and external forces act.
Positions prediction(const ProjectiveSystem& system, double dt);

/// 1/(2h²) |M^½ (x − y)|² + E(x) at the end of a step [J].
double objective_after(const ProjectiveSystem& system, double dt);

/// −∇ of it, 0 for fixed particles [N].
Forces unbalanced_after(const ProjectiveSystem& system, double dt);

/// A of projective dynamics, from the elements' entries one by one.
Eigen::MatrixXd dense_matrix(const ProjectiveSystem& system, double dt);

double metric(const StepReport& report, std::string_view name);

bool warns(const StepReport& report, const std::string& text);

/// Particles at `x` of 10 g each, at rest, without external forces.
ProjectiveSystem system_at(const Positions& x, double mass = 0.01);

void pull_down(ProjectiveSystem& system);

/// A net of springs between random particles: a path through all of them and `extra` more springs
/// a particle. Their rest lengths are the distances times `rest`.
ProjectiveSystem spring_net(int particles, int extra, double stiffness, double rest,
                            std::uint64_t seed = 1);

/// A sheet that only bends: its energy is quadratic, the step's forces are linear. Held by a corner
/// and in random motion under gravity.
ProjectiveSystem bending_sheet(const TriangleMesh& mesh, double stiffness);
/// A step whose forces are linear.
StepProblem linear_problem();

/// A block of tetrahedra, one face held, in random motion.
ProjectiveSystem solid_block(const ElasticMaterial& material);

/// Nonlinear problems without constraints, from soft to stiff, with fixed particles, of every kind.
std::vector<StepProblem> step_problems();

inline std::string problem_name(const testing::TestParamInfo<StepProblem>& info) {
  return info.param.name;
}

}  // namespace pliant
