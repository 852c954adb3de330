#pragma once

#include "pliant/effects/air_gas.h"
#include "pliant/effects/bubbles.h"

namespace pliant {

// The cloth over a bubble is at its `x`, with the feet of there. A change of its pressure by delta
// moves vertices by delta m dV/dx, with their `mobility` m, and the pressure that belongs to the
// volume which that makes is solved for: implicit, so that V -> 0 or V_0 = 0 cannot blow up.

/// Sets the gradient.
void take_gradient(Bubble& bubble);

/// By how much the pressure has to change [Pa], where `leak` [m³/Pa] is what flows in through weave
/// and edge for each pascal that the room's pressure is above its own.
double pressure_change(const AirGas& gas, double leak, Bubble& bubble);

/// Largest change that moves no vertex further than `way` [m]; [Pa].
double largest_pressure_change(const Bubble& bubble, double way);

/// Sets its `moved` to where the vertices are then.
void move_bubble(double delta, Bubble& bubble);

}  // namespace pliant
