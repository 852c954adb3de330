#include "pliant/solvers/newton.h"

#include <limits>

namespace pliant {
namespace {

using Triplet = Eigen::Triplet<double>;

// Of a particle's 1/D, for the compliance with which constraints stand in the Hessian. Multipliers
// make up for it, the sooner the smaller it is.
constexpr double kConstraintCompliance = 0.4;
// Iterations under constraints after which one takes the projected Hessian.
constexpr int kExactFor = 10;

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

void NewtonSolver::prepare_iterations(const ProjectiveSystem& system) {
  FactoredSolver::prepare_iterations(system);
  mobility_of_constraints_ =
      kConstraintCompliance * free_mobility(objective().diagonal(), system.particles);
}

void NewtonSolver::begin_iterations(ProjectiveSystem& system, StepReport& report) {
  FactoredSolver::begin_iterations(system, report);
  projected_ = 0;
  takes_exact_ = true;
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
    analyze(hessian_);
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

bool NewtonSolver::iterate_with_constraints(ProjectiveSystem& system, StepReport& report) {
  constrained().collect(system);
  correction() = forces();
  {
    ScopedPhase phase(report, "global");
    bool is_solved = false;
    for (const Definiteness definiteness : {Definiteness::kExact, Definiteness::kProjected}) {
      // With constraints in it a matrix may be definite although the Hessian is not, and then the
      // function that they are found by is not convex: full steps say that it is.
      if (definiteness == Definiteness::kExact && !takes_exact_) continue;
      assemble(system, definiteness);
      is_solved = constrained().solve(
          system, mobility_of_constraints_,
          [this](const ConstraintRows& rows, Eigen::Matrix3Xd& v) { return solve_with(rows, v); },
          correction());
      if (is_solved) break;
      correction() = forces();
      ++projected_;
    }
    if (!is_solved) return false;
  }
  ScopedPhase phase(report, "line_search");
  takes_exact_ = search_along(system) == 1.0 && report.iterations % kExactFor != 0;
  return true;
}

bool NewtonSolver::solve_with(const ConstraintRows& rows, Eigen::Matrix3Xd& v) {
  with_rows_ = hessian_;
  for (int r = 0; r < rows.size(); ++r) {
    const Eigen::Matrix3d block =
        rows.direction(r) * rows.direction(r).transpose() / rows.compliance(r);
    for (const auto* a = rows.begin(r); a != rows.end(r); ++a) {
      for (const auto* b = rows.begin(r); b != rows.end(r); ++b) {
        add_block(a->particle, b->particle, a->weight * b->weight * block);
      }
    }
  }
  with_rows_.makeCompressed();
  // Pairs of places that touch add blocks where they will, so that their number tells nothing.
  if (with_rows_.nonZeros() > hessian_.nonZeros()) analyzed_ = kUnknown;
  analyze(with_rows_);
  if (with_rows_.nonZeros() > hessian_.nonZeros()) analyzed_ = kUnknown;
  llt_.factorize(with_rows_);
  if (llt_.info() != Eigen::Success) return false;
  solve(v);
  return true;
}

void NewtonSolver::add_block(int row, int column, const Eigen::Matrix3d& block) {
  if (row < column || mobility_of_constraints_[row] == 0.0 ||
      mobility_of_constraints_[column] == 0.0) {
    return;
  }
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) with_rows_.coeffRef(3 * row + r, 3 * column + c) += block(r, c);
  }
}

void NewtonSolver::analyze(const Matrix& matrix) {
  // Elements leave entries out only where they have no direction, which is rare.
  if (matrix.nonZeros() == analyzed_) return;
  llt_.analyzePattern(matrix);
  analyzed_ = matrix.nonZeros();
}

bool NewtonSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  Positions& x = system.particles.x;
  const auto p = [this](Eigen::Matrix3Xd& v) { apply(v); };
  const auto p_inverse = [this](Eigen::Matrix3Xd& v) { solve(v); };
  if (finds_multipliers(system)) return iterate_with_constraints(system, report);
  if (!begin_correction(system, report)) return true;
  start_ = x;
  {
    ScopedPhase phase(report, "global");
    if (!factor(system)) return false;
    coupled().solve(rows(), system.particles, p, p_inverse, correction());
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
