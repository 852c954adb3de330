#pragma once

#include "pliant/core/system/point_constraint.h"
#include "pliant/effects/air/air_gas.h"
#include "pliant/effects/air/bubbles.h"
#include "pliant/effects/strain_limit/linear_constraints.h"

namespace pliant {

// The cloth over a bubble is at its `x`, with the foot points of there. A change of its pressure by
// delta moves vertices by delta m dV/dx, with their `mobility` m, and the pressure that belongs to
// the volume which that makes is solved for: implicit, so that V -> 0 or V_0 = 0 cannot blow up. Of
// wet vertices it is the volume once contact `held` them back: else air would press with what lifts
// cloth that nothing holds, and water would take all of that back, over and over.

/// Volume of what is no cloth under it; negative where the cloth passed through itself [m³].
double air_volume(Bubble& bubble);

/// How much more that is than its air has at its pressure with the change, and what leaks in [m³];
/// 0 where it is less and nothing is there to be pressed. `leak` as below.
double surplus(const AirGas& gas, double leak, Bubble& bubble);

/// Area of what is lifted of it, at rest [m²].
double lifted_area(const Bubble& bubble);

/// That volume and pressure keep the gas' law, to first order, where the vertices go on from `x`
/// and none of those that lie goes down: a condition of its gradient, which it sets, on a change of
/// the pressure. The owner is left to the caller.
void set_volume_condition(const AirGas& gas, double leak, Bubble& bubble,
                          LinearConstraint& condition);

/// The gas' law squeeze(p) V = V_0 - leak p as a constraint whose multiplier is the gauge pressure,
/// to first order in both; the gradient, dV/dx, is left to the caller.
void set_gas_constraint(const AirGas& gas, double leak, Bubble& bubble, TyingConstraint& tie);

/// Change of the pressure that takes a surplus away by what is lifted and has `mobility`, to first
/// order, in which no vertex moves further than `distance` [m]; [Pa]. Sets the gradient, and the
/// mobility of what lies to 0.
double pressing_change(const AirGas& gas, double surplus, double distance, Bubble& bubble);

/// Sets the gradient: where the vertices are, or, with an `expected` change of the pressure [Pa],
/// where that moved them along the last gradient. An iteration that ends where it began needs the
/// gradient of there, not of where the elements alone moved the vertices.
void take_gradient(Bubble& bubble, double expected = 0.0);

/// Lets the vertices go on from where they are along the gradient that is there: what the pressure
/// did before in the same iteration went along it, and forces are told by it.
void keep_gradient(Bubble& bubble);

/// By how much the pressure has to change [Pa], where `leak` [m³/Pa] is what flows in through weave
/// and edge for each pascal that the room's pressure is above its own.
double pressure_change(const AirGas& gas, double leak, Bubble& bubble);

/// Largest change that moves no vertex further than `distance` [m]; [Pa].
double largest_pressure_change(const Bubble& bubble, double distance);

/// Sets its `moved` to where the vertices are then.
void move_bubble(double delta, Bubble& bubble);

}  // namespace pliant
