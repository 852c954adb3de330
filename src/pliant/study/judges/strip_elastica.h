#pragma once

namespace pliant {

// An inextensible strip of bending stiffness B and weight w per area that is clamped level:
// B θ'' = -w (L - s) cos θ, θ(0) = 0, θ'(L) = 0 (Bickley 1934, "The heavy elastica"). All lengths
// are in (B/w)^(1/3).

/// Where a strip ends, seen from its clamp.
struct StripTip {
  double along = 0.0, below = 0.0;
};
StripTip elastica_tip(double length);
/// The angle of a strip of that length below the level of the line from its clamp to its tip [rad].
double elastica_chord_angle(double length);
/// The length at which that angle is `angle`, in (0, 1.4) [rad].
double elastica_overhang(double angle);

}  // namespace pliant
