#pragma once

namespace pliant {

class Group;

/// In how many equal parts a group's next step of `dt` [s] is taken for the sake of an impact in
/// the last one: impacts are of first order, which damps, so that steps are short until nothing
/// hits any more and nothing throws a body back, and then grow. 1 where the integration is of first
/// order, and where no body moves faster than what fell for a step.
int parts_after_impact(const Group& group, double dt);

}  // namespace pliant
