#include "pliant/solvers/iterations/gauss_seidel.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

constexpr int kGrain = 64;

/// r_i − sum_j A_ij d_j.
Eigen::Vector3d unbalanced(const SparseRows& a, int i, const Forces& r, const Positions& d) {
  Eigen::Vector3d sum = r.col(i);
  const int* columns = a.innerIndexPtr();
  const double* values = a.valuePtr();
  for (int e = a.outerIndexPtr()[i]; e < a.outerIndexPtr()[i + 1]; ++e) {
    sum -= values[e] * d.col(columns[e]);
  }
  return sum;
}

/// Whether no constraint ties many particles.
bool may_sweep(const ProjectiveSystem& system) {
  return std::none_of(system.constraints.begin(), system.constraints.end(),
                      [](const Constraint* constraint) { return constraint->is_collective(); });
}

}  // namespace

void GaussSeidelSolver::prepare_iterations(const ProjectiveSystem& system) {
  sweeps_ = may_sweep(system);
  relaxation_ = make_relaxation(product(), system.particles);
  coloring_ = color_vertices(matrix(), system.particles, max_colors_);
  // Overflow particles move at the same time: their diagonal has to bound their part of A.
  mobility_ = free_mobility(objective().diagonal() + overflow_row_sums(matrix(), coloring_),
                            system.particles);
  correction_.resize(3, matrix().rows());
  overflow_.resize(3, static_cast<Eigen::Index>(coloring_.overflow.size()));
}

void GaussSeidelSolver::begin_iterations(ProjectiveSystem& system, StepReport& report) {
  sweeps_ = may_sweep(system);
  report.add_metric("colors", static_cast<double>(coloring_.colors.size()));
  report.add_metric("overflow", static_cast<double>(coloring_.overflow.size()));
}

void GaussSeidelSolver::sweep() {
  correction_.setZero();
  for (const std::vector<int>& color : coloring_.colors) {
    parallel_for(0, static_cast<int>(color.size()), kGrain, [&](int begin, int end) {
      for (int k = begin; k < end; ++k) {
        const int i = color[static_cast<std::size_t>(k)];
        correction_.col(i) = mobility_[i] * unbalanced(matrix(), i, balance_, correction_);
      }
    });
  }
  const int left = static_cast<int>(coloring_.overflow.size());
  parallel_for(0, left, kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const int i = coloring_.overflow[static_cast<std::size_t>(k)];
      overflow_.col(k) = mobility_[i] * unbalanced(matrix(), i, balance_, correction_);
    }
  });
  for (int k = 0; k < left; ++k) {
    correction_.col(coloring_.overflow[static_cast<std::size_t>(k)]) = overflow_.col(k);
  }
}

bool GaussSeidelSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  if (!sweeps_) {
    jacobi_update(system, relaxation_.mobility, report);
    return true;
  }
  // A sweep spreads a particle's force to its neighbours: it has to know what constraints balance.
  balance_ = forces();
  for (const Constraint* constraint : system.constraints) constraint->add_forces(balance_);
  {
    ScopedPhase phase(report, "sweep");
    sweep();
    system.particles.x += correction_;
  }
  relax_constraints(system, mobility_, report);
  return true;
}

namespace {

std::unique_ptr<Solver> make_sweeps(const Parameters& given, int max_colors) {
  const StopRule rule = stop_rule(given);
  auto solver = std::make_unique<GaussSeidelSolver>(rule, max_colors);
  DeviceSolverSpec spec = {solver->name(), rule};
  spec.iteration = {DeviceIteration::kSweep, 1.0, max_colors};
  return make_on_backend(given.text("backend"), std::move(solver), spec);
}

}  // namespace

SolverRegistry::Entry gauss_seidel_entry() {
  std::vector<ParameterSpec> parameters = stop_rule_parameters("30");
  parameters.push_back(backend_parameter());
  return {"gauss_seidel",
          "projective dynamics by coloured Gauss-Seidel sweeps; converges about twice as fast as "
          "jacobi, fewer particles at a time; plain jacobi where there is air or a strain limit of "
          "cloth",
          parameters, projective_models(),
          [](const Parameters& given) { return make_sweeps(given, 0); }};
}

SolverRegistry::Entry hybrid_entry() {
  std::vector<ParameterSpec> parameters = stop_rule_parameters("30");
  parameters.push_back(integer_parameter(
      "colors", "8", 1, 64, "most colours of a sweep; particles left over take a Jacobi update"));
  parameters.push_back(backend_parameter());
  return {
      "hybrid",
      "gauss_seidel with a bounded number of colours, the rest by jacobi: for many threads; plain "
      "jacobi where there is air or a strain limit of cloth",
      parameters, projective_models(),
      [](const Parameters& given) { return make_sweeps(given, given.integer("colors")); }};
}

}  // namespace pliant
