#pragma once

namespace pliant {

/// What a body of particles (BlendedParticles) and its effects do in each substep of a resident
/// run, besides what ResidentRun tells of any body.
struct ParticleResidentRun {
  bool flows = false;        ///< particles feel each other's pressure and viscosity
  bool meets_walls = false;  ///< and that of obstacles
  bool melts = false;        ///< some particle's beta is above 0, so that effects of liquids act
  /// While the speed of the fastest particle is between these, steps have as many substeps as those
  /// of the run; the run ends with the first step after which it is not [m/s].
  double least_speed = -1.0, most_speed = 0.0;
  double cohesion = 0.0;  ///< factor A of the attraction −A Vᵢ Vⱼ W(poly6) [Pa]
  double mixing = 0.0;    ///< share of XSPH in a substep, as XsphEffect has it
};

}  // namespace pliant
