#pragma once

namespace pliant {

/// An inextensible strip of bending stiffness B and weight w per area that is clamped level:
/// B θ'' = -w (L - s) cos θ, θ(0) = 0, θ'(L) = 0 (Bickley 1934, "The heavy elastica").
/// The angle below the level of the line from its clamp to its tip for a length L of so many
/// (B/w)^(1/3) [rad].
double elastica_chord_angle(double length);
/// The length, in (B/w)^(1/3), at which that angle is `angle`, in (0, 1.4) [rad].
double elastica_overhang(double angle);

}  // namespace pliant
