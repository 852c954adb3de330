#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pliant/study/generated/generated_scene.h"

namespace pliant {

/// What came of a generated scene, told in one way. Lengths are of that telling.
struct GeneratedRun {
  std::string refusal;        ///< why it was not built, or a step not taken; empty: neither
  bool is_built = false;      ///< false: it was refused as a scene
  bool is_finite = true;      ///< also after a step that was refused
  Positions points;           ///< of the first body at the end: what it has [m]
  std::vector<double> state;  ///< positions and velocities of its particles at the end
  std::uint64_t hash = 0;     ///< of the states of all bodies after every step, bit for bit
  double mass = 0.0;          ///< of all bodies [kg]
  double energy_start = 0.0;  ///< kinetic and elastic [J]
  /// The most by which kinetic energy and gravity's were above all of the start's [J]. Steps that
  /// have not converged leave a body softer than it is, which then may store more than there is;
  /// but nothing moves more lively for it.
  double energy_gained = 0.0;
  double momentum_missing = 0.0;  ///< between what it is and what gravity makes of it [kg m/s]
  double momentum_scale = 0.0;    ///< of all particles' without their signs, the most [kg m/s]
  double travel = 0.0;            ///< of the point of the first body that came farthest [m]
  double reach = 0.0;             ///< of the first body's points from the origin, at the end [m]
  double depth = 0.0;             ///< of a point within an obstacle, or in the other body [m]
  int steps = 0;                  ///< taken
  bool is_warned = false;         ///< some step said something, or was taken in substeps
  std::optional<double> error;    ///< that the last step told of the first body
  bool is_inaccurate = false;     ///< the last step warned of that
  /// Some step said that it is inaccurate, did not converge or was held back.
  bool is_unsure = false;
  /// Of the first body's points: where they began and their masses, 0 of those that are held.
  Positions start;
  Eigen::VectorXd weight;  ///< [kg]
  /// Some step said that it is off by half of the travel or more, or was held back: then decisions
  /// of the solver, which round-off may turn, make the result.
  bool is_lost = false;
  double seconds = 0.0;  ///< of the processor
};

GeneratedRun run_generated(const SceneChoice& choice, const SceneTelling& telling, int threads,
                           const std::string& robot);

}  // namespace pliant
