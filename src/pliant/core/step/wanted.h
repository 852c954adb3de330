#pragma once

namespace pliant {

/// What somebody who looks at a body between two series of steps (step_series.h) wants to see of
/// it; each includes those before it. What nobody wants may stay where a solver computes.
enum class Wanted {
  kNothing,  ///< the report, and forces on obstacles
  kSurface,  ///< the vertices of what is drawn
  kMotion,   ///< positions and velocities of all particles
  kState     ///< all that the next step depends on
};

}  // namespace pliant
