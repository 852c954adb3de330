#pragma once

namespace pliant {

/// What a body of particles (BlendedParticles) and its effects do in each part of a series of
/// steps, besides what StepSeries tells of any body.
struct ParticleSeries {
  bool flows = false;        ///< particles feel each other's pressure and viscosity
  bool meets_walls = false;  ///< and that of obstacles
  bool melts = false;        ///< some particle's beta is above 0, so that effects of liquids act
  /// While the fastest particle's is between these, steps have as many parts as those of the
  /// series; where it is not at the end of one, the series ends there [m/s].
  double least_speed = -1.0, most_speed = 0.0;
  double cohesion = 0.0;  ///< factor A of the attraction −A Vᵢ Vⱼ W(poly6) [Pa]
  double mixing = 0.0;    ///< share of XSPH in a part, as XsphEffect has it
};

}  // namespace pliant
