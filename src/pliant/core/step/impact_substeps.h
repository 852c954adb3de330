#pragma once

namespace pliant {

class Group;

/// In how many equal substeps a group's next step of `dt` [s] is taken for the sake of an impact in
/// the last one: impacts are of first order, which damps, so that steps are short until nothing
/// hits any more and nothing throws a body back, and then grow. 1 where the integration is of first
/// order, and where no body moves faster than what fell for a step.
int substeps_after_impact(const Group& group, double dt);

/// In how many equal substeps a group has to take the step of `dt` [s] again that its solver has
/// just ended whole, since something hit in it: a whole step of first order would damp the impact
/// by what the step is long. 1: it stays as it is.
int substeps_for_impact(const Group& group, double dt);

/// Back to the beginning of a step that the solver has ended whole and that no model or effect has
/// ended yet, for another try.
void take_back(Group& group);

}  // namespace pliant
