#pragma once

namespace pliant {

/// What of a body is read back from where its solver computes for those who observe it between two
/// resident runs (resident_run.h); each includes those before it. The rest may stay there.
enum class Readback {
  kNothing,  ///< the report, and forces on obstacles
  kSurface,  ///< the vertices of what is drawn
  kMotion,   ///< positions and velocities of all particles
  kState     ///< all that the next step depends on
};

}  // namespace pliant
