// What ConstrainedCorrection does with constraints that tie many particles.
#include <algorithm>
#include <cmath>

#include "pliant/solvers/constrained/constrained_correction.h"

namespace pliant {

void ConstrainedCorrection::begin_ties(const Eigen::VectorXd& mobility) {
  ties_.assign(constraints_.ties.size(), {});
  for (std::size_t t = 0; t < ties_.size(); ++t) {
    const TyingConstraint& constraint = constraints_.ties[t];
    Tie& tie = ties_[t];
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& gradient = constraints_.gradients[static_cast<std::size_t>(e)];
      tie.own += gradient.value.squaredNorm() * mobility[gradient.particle];
      tie.scale += gradient.value.squaredNorm();
    }
    tie.scale = std::sqrt(tie.scale);
    if (tie.own == 0.0) continue;
    tie.compliance = constraint.compliance + compliance_share_ * tie.own;
    tie.kept = tie.used = tie.answer = tie.next = constraint.force;
  }
}

double ConstrainedCorrection::displacement(const TyingConstraint& constraint,
                                           const Positions& d) const {
  double sum = 0.0;
  for (int e = constraint.begin; e < constraint.end; ++e) {
    const auto& gradient = constraints_.gradients[static_cast<std::size_t>(e)];
    sum += gradient.value.dot(d.col(gradient.particle));
  }
  return sum;
}

void ConstrainedCorrection::answer_ties(const Positions& d, double share) {
  for (std::size_t t = 0; t < ties_.size(); ++t) {
    Tie& tie = ties_[t];
    if (tie.compliance == 0.0) continue;
    const TyingConstraint& constraint = constraints_.ties[t];
    double moved = displacement(constraint, d);
    if (share != 0.0) moved += share * displacement(constraint, move_);
    const double free = tie.kept - (constraint.gap + moved) / tie.compliance;
    tie.answer = std::clamp(free, constraint.lowest, constraint.highest);
    tie.is_bound = tie.answer != free;
  }
}

void ConstrainedCorrection::add_tie_forces(double Tie::*which, double sign, Forces& f) const {
  for (std::size_t t = 0; t < ties_.size(); ++t) {
    const TyingConstraint& constraint = constraints_.ties[t];
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& gradient = constraints_.gradients[static_cast<std::size_t>(e)];
      f.col(gradient.particle) += sign * ties_[t].*which * gradient.value;
    }
  }
}

void ConstrainedCorrection::add_tie_violations(const Eigen::VectorXd& mobility,
                                               Eigen::VectorXd& violations) const {
  for (std::size_t t = 0; t < ties_.size(); ++t) {
    const TyingConstraint& constraint = constraints_.ties[t];
    const double squared = (ties_[t].answer - ties_[t].kept) * (ties_[t].answer - ties_[t].kept);
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& gradient = constraints_.gradients[static_cast<std::size_t>(e)];
      violations[gradient.particle] +=
          gradient.value.squaredNorm() * mobility[gradient.particle] * squared;
    }
  }
}

void ConstrainedCorrection::find_tie_forces() {
  // Of those in the matrix: what they answer to the round's displacement too.
  for (std::size_t t = 0; t < ties_.size(); ++t) {
    Tie& tie = ties_[t];
    if (tie.compliance == 0.0 || tie.is_bound) continue;
    tie.next = tie.answer - displacement(constraints_.ties[t], move_) / tie.compliance;
  }
}

double ConstrainedCorrection::work(double Tie::*which) const {
  double sum = 0.0;
  for (std::size_t t = 0; t < ties_.size(); ++t) {
    sum += ties_[t].*which * displacement(constraints_.ties[t], move_);
  }
  return sum;
}

}  // namespace pliant
