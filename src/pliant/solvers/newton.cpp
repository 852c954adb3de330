#include "pliant/solvers/newton.h"

#include <limits>

namespace pliant {
namespace {

using Triplet = Eigen::Triplet<double>;

/// Collects blocks between particles that are free.
class FreeBlocks final : public StiffnessMatrix {
 public:
  FreeBlocks(const Particles& particles, std::vector<Triplet>& entries)
      : particles_(particles), entries_(entries) {}
  void add(int row, int column, const Eigen::Matrix3d& block) override {
    if (particles_.is_fixed(row) || particles_.is_fixed(column)) return;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) entries_.emplace_back(3 * row + r, 3 * column + c, block(r, c));
    }
  }

 private:
  const Particles& particles_;
  std::vector<Triplet>& entries_;
};

}  // namespace

void NewtonSolver::begin_iterations(ProjectiveSystem& system, StepReport& report) {
  FactoredSolver::begin_iterations(system, report);
  projected_ = 0;
}

void NewtonSolver::assemble(const ProjectiveSystem& system, Definiteness definiteness) {
  const Particles& particles = system.particles;
  entries_.clear();
  for (int i = 0; i < particles.size(); ++i) {
    const double inertia = particles.is_fixed(i) ? 1.0 : objective().inertia()[i];
    for (int c = 0; c < 3; ++c) entries_.emplace_back(3 * i + c, 3 * i + c, inertia);
  }
  FreeBlocks blocks(particles, entries_);
  for (const auto& set : system.elements) set->add_stiffness(particles.x, definiteness, blocks);
  hessian_.resize(3 * particles.size(), 3 * particles.size());
  hessian_.setFromTriplets(entries_.begin(), entries_.end());
}

bool NewtonSolver::factor(const ProjectiveSystem& system) {
  for (const Definiteness definiteness : {Definiteness::kExact, Definiteness::kProjected}) {
    assemble(system, definiteness);
    // Elements leave entries out only where they have no direction, which is rare.
    if (hessian_.nonZeros() != analyzed_) {
      llt_.analyzePattern(hessian_);
      analyzed_ = hessian_.nonZeros();
    }
    llt_.factorize(hessian_);
    if (llt_.info() == Eigen::Success) {
      if (definiteness == Definiteness::kProjected) ++projected_;
      return true;
    }
  }
  return false;
}

void NewtonSolver::solve(Eigen::Matrix3Xd& v) const {
  Eigen::Map<Eigen::VectorXd> flat(v.data(), v.size());
  flat = llt_.solve(flat).eval();
}

void NewtonSolver::apply(Eigen::Matrix3Xd& v) const {
  Eigen::Map<Eigen::VectorXd> flat(v.data(), v.size());
  flat = (hessian_ * flat).eval();
}

bool NewtonSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  Positions& x = system.particles.x;
  if (!begin_correction(system, report)) return true;
  start_ = x;
  {
    ScopedPhase phase(report, "global");
    if (!factor(system)) return false;
    coupled().solve(
        rows(), system.particles, [this](Eigen::Matrix3Xd& v) { apply(v); },
        [this](Eigen::Matrix3Xd& v) { solve(v); }, correction());
  }
  double step;
  {
    ScopedPhase phase(report, "line_search");
    step = search(system, start_);
  }
  end_correction(system, report);
  // What couplings hold is not found yet where nothing moves any more.
  if (!system.couplings.empty()) return true;
  const double reach = std::numeric_limits<double>::epsilon() * x.cwiseAbs().maxCoeff();
  return (x - start_).cwiseAbs().maxCoeff() > reach && step > 0.0;
}

void NewtonSolver::end_iterations(ProjectiveSystem& system, StepReport& report) {
  FactoredSolver::end_iterations(system, report);
  report.add_figure("projected_hessians", projected_);
}

SolverRegistry::Entry newton_entry() {
  std::vector<ParameterSpec> parameters = stop_rule_parameters("200");
  for (ParameterSpec& parameter : parameters) {
    if (parameter.name == "tolerance") parameter.default_value = "1e-10";
  }
  return {"newton",
          "Newton's method with line search, to convergence: the reference, slow and exact",
          parameters, projective_models(),
          [](const Parameters& given) { return std::make_unique<NewtonSolver>(stop_rule(given)); }};
}

}  // namespace pliant
