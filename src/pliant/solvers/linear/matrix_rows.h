#pragma once

#include "pliant/core/system/constraint.h"
#include "pliant/solvers/constrained/held_rows.h"
#include "pliant/solvers/constrained/point_constraint_rows.h"

namespace pliant {

/// Appends equations of constraints as springs of their compliances; gradients of pinned particles,
/// whose `mobility` is 0, are left out.
void append_springs(const PointConstraintRows& rows, const Eigen::VectorXd& mobility,
                    HeldRows& springs);

/// Likewise of what constraints hold, each with Σ |g|² `mobility` [m/N] added to its compliance, so
/// that the springs are no stiffer than what they hold. Rows that hold pinned particles alone get a
/// stiffness of 0.
void append_springs(const ConstraintRows& rows, const Eigen::VectorXd& mobility, HeldRows& springs);

}  // namespace pliant
