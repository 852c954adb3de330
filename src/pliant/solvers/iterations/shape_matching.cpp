#include "pliant/solvers/iterations/shape_matching.h"

#include "pliant/core/parallel/parallel.h"
#include "pliant/elements/clusters/cluster_source.h"

namespace pliant {

void ShapeMatchingSolver::prepare_system(const ProjectiveSystem& system, double dt) {
  mobility_ = dt * dt * system.particles.inverse_mass;
  version_ = 0;
}

void ShapeMatchingSolver::look_at_elements(const ProjectiveSystem& system) {
  clusters_ = nullptr;
  others_.clear();
  for (const auto& set : system.elements) {
    bool are_clusters = false;
    const ClusterSet* clusters = clusters_of(*set, are_clusters);
    if (!are_clusters) others_.push_back(set.get());
    if (clusters != nullptr) clusters_ = clusters;
  }
  // Rest shapes may creep from step to step, and nobody prepares a solver for that.
  if (clusters_ == nullptr || clusters_->version() == version_) return;
  sweep_.prepare(*clusters_, system.particles.inverse_mass);
  version_ = clusters_->version();
}

double ShapeMatchingSolver::strain(const ProjectiveSystem& system) const {
  return clusters_ != nullptr ? sweep_.strain(*clusters_, system.particles.x) : 0.0;
}

void ShapeMatchingSolver::iterate(ProjectiveSystem& system, double dt, StepReport& report) {
  Particles& particles = system.particles;
  if (clusters_ != nullptr) {
    const ScopedPhase phase(report, "cluster");
    sweep_.iterate(*clusters_, particles.x);
  }
  // Goals keep nothing of what others moved, so that these begin anew.
  for (ElementSet* set : others_) {
    const ScopedPhase phase(report, set->name());
    set->reset_multipliers();
    set->relax(particles.inverse_mass, dt, particles.x);
  }
  reset_constraints(system);
  relax_constraints(system, mobility_, report);
}

void ShapeMatchingSolver::take_share(Positions& x) const {
  const Eigen::VectorXd& parts = sweep_.parts();
  for (int i = 0; i < static_cast<int>(parts.size()); ++i) {
    const double share = alpha_ * parts[i];
    if (parts[i] == 0.0 || share == 1.0) continue;
    x.col(i) = predicted_.col(i) + share * (x.col(i) - predicted_.col(i));
  }
}

void ShapeMatchingSolver::solve(ProjectiveSystem& system, double dt, StepReport& report) {
  look_at_elements(system);
  predicted_ = system.particles.x;
  reset_constraints(system);
  StopCheck stop(rule(), report);
  do {
    while (stop.next()) {
      if (stop.wants_residual(!system.constraints.empty())) {
        const double left = strain(system);
        // Before contacts are asked, that shapes fit says nothing of what is in the way.
        const bool asked = (system.constraints.empty() && others_.empty()) || report.iterations > 1;
        if (stop.converged(asked ? left : 1.0)) break;
      }
      iterate(system, dt, report);
    }
  } while (finds_more(system, report) && stop.go_on());
  if (stop.is_residual_old()) stop.set_residual(strain(system));
  stop.warn_unless_converged();
  if (report.step == 1 && clusters_ != nullptr) {
    report.warn(
        "modulus_ignored: shape_matching moves particles to the goals of their clusters, whatever "
        "`young` and `alpha` of the material are: its `iterations`, its `alpha` and the time step "
        "say how stiff a body is; jacobi and others keep to the modulus");
  }
  if (report.iterations > 0 && clusters_ != nullptr) take_share(system.particles.x);
  const bool moved = report.iterations > 0;
  end_step(system, moved ? held_.settle(system, mobility_, dt) : mobility_, report);
}

namespace {

ClusterOrder order_of(const Parameters& given) {
  const std::string& sweep = given.text("sweep");
  if (sweep == "gauss_seidel") return {0, false};
  if (sweep == "hybrid") return {given.integer("groups"), false};
  return {1, sweep == "weighted_jacobi"};
}

}  // namespace

SolverRegistry::Entry shape_matching_entry() {
  std::vector<ParameterSpec> parameters = stop_rule_parameters("10");
  parameters.push_back(choice_parameter(
      "sweep", "weighted_jacobi", {"jacobi", "weighted_jacobi", "gauss_seidel", "hybrid"},
      "how clusters that share particles are made to agree: all at once, by the mean of what they "
      "want; the same with weights by how much each is deformed; one after the other; or groups "
      "after each other, by the mean within each"));
  parameters.push_back(integer_parameter("groups", "8", 1, 1000, "of `hybrid`"));
  parameters.push_back(number_parameter(
      "alpha", "", "1", 0.0, 1.0, "of the displacement to its shape that a body takes in a step"));
  return {"shape_matching",
          "clusters move particles to their goals, without a modulus: stiffens with iterations, as "
          "in the paper; `tolerance` is of the clusters' mean strain",
          parameters,
          {"viscoelastic"},
          [](const Parameters& given) {
            return std::make_unique<ShapeMatchingSolver>(stop_rule(given), order_of(given),
                                                         given.number("alpha"));
          }};
}

}  // namespace pliant
