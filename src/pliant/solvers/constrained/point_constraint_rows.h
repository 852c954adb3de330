#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/core/system/point_constraint.h"

namespace pliant {

/// Equations on the displacements e of particles, n · u_c(e) = t + C μ, with u_c = Σ w e the
/// displacement of a constraint's point and −n μ the force on it.
class PointConstraintRows {
 public:
  void clear(const PointConstraints& constraints) {
    constraints_ = &constraints;
    rows_.clear();
    ties_.clear();
  }
  void append(int constraint, const Eigen::Vector3d& direction, double compliance, double target) {
    rows_.push_back({constraint, direction, compliance, target});
  }

  int size() const { return static_cast<int>(rows_.size()); }

  /// Equations of those that tie many particles, with a target of 0, are kept apart.
  struct Tie {
    int constraint;
    double compliance;
  };
  void append_tie(int constraint, double compliance) { ties_.push_back({constraint, compliance}); }
  const std::vector<Tie>& ties() const { return ties_; }
  const PointConstraints::Gradient* begin(const Tie& tie) const {
    return constraints_->gradients.data() + of(tie).begin;
  }
  const PointConstraints::Gradient* end(const Tie& tie) const {
    return constraints_->gradients.data() + of(tie).end;
  }
  int constraint(int row) const { return at(row).constraint; }
  /// Whether it holds its constraint's gap, not its slip.
  bool is_normal(int row) const { return direction(row).dot(of(row).normal) > 0.5; }
  const Eigen::Vector3d& direction(int row) const { return at(row).direction; }
  double compliance(int row) const { return at(row).compliance; }  ///< C [m/N]
  double target(int row) const { return at(row).target; }          ///< t [m]
  const PointConstraints::Entry* begin(int row) const {
    return constraints_->entries.data() + of(row).begin;
  }
  const PointConstraints::Entry* end(int row) const {
    return constraints_->entries.data() + of(row).end;
  }

  /// f += Jᵀ mu.
  void spread(const Eigen::VectorXd& mu, Forces& f) const;
  /// values = J e.
  void gather(const Positions& e, Eigen::VectorXd& values) const;
  /// The same between some of the particles: particle i has the column column_of[i], and no column
  /// where that is negative. Only the first three numbers of a column count.
  void spread(const Eigen::VectorXd& mu, const std::vector<int>& column_of,
              Eigen::Matrix4Xd& f) const;
  void gather(const Eigen::Matrix4Xd& e, const std::vector<int>& column_of,
              Eigen::VectorXd& values) const;

 private:
  struct Row {
    int constraint;
    Eigen::Vector3d direction;
    double compliance, target;
  };
  /// Calls body(first row, number) for the rows of each constraint, which follow one another: at
  /// most three, a number that the compiler knows. Taken together they read and write once what
  /// their particles have.
  template <class Body>
  void for_constraints(const Body& body) const;
  template <class ColumnOf, class Columns>
  void spread_to(const Eigen::VectorXd& mu, const ColumnOf& column_of, Columns& f) const;
  template <class ColumnOf, class Columns>
  void gather_from(const Columns& e, const ColumnOf& column_of, Eigen::VectorXd& values) const;

  const Row& at(int row) const { return rows_[static_cast<std::size_t>(row)]; }
  const PointConstraint& of(int row) const {
    return constraints_->all[static_cast<std::size_t>(at(row).constraint)];
  }

  const TyingConstraint& of(const Tie& tie) const {
    return constraints_->ties[static_cast<std::size_t>(tie.constraint)];
  }

  const PointConstraints* constraints_ = nullptr;
  std::vector<Row> rows_;
  std::vector<Tie> ties_;
};

}  // namespace pliant
