#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/world.h"

namespace pliant {

/// What errors are measured on.
struct StateSample {
  std::vector<Positions> positions;  ///< of each body [m]
  Energies energies;
  double largest_strain = 0.0;  ///< |l / l_0 - 1| of the surfaces' edges; l_0 is the scene's start
};

/// The state at time step 0 of a method of first order, from those at the steps h and 2 h:
/// 2 s(h) - s(2 h).
StateSample extrapolated(const StateSample& fine, const StateSample& coarse, int order = 1);

/// What errors are divided by; never 0.
struct ErrorScale {
  double distance = 1.0;  ///< [m]
  double energy = 1.0;    ///< [J]
};

/// How far a state is from the reference's. Infinite where the state is not finite.
struct Errors {
  double position = 0.0;  ///< rms over the scale's distance
  double rms = 0.0;       ///< mass-weighted root mean square of the distances of vertices [m]
  double largest = 0.0;   ///< distance of a vertex [m]
  double energy = 0.0;    ///< difference of the total energies over the scale's energy
  double strain = 0.0;    ///< difference of the largest strains
};

/// Measures errors of the states of one scene, all its bodies together.
class ErrorMeter {
 public:
  /// `start` is the scene before its first step.
  explicit ErrorMeter(const World& start);

  StateSample sample(const World& world) const;
  /// sqrt(sum m |a - b|² / sum m) [m].
  double distance(const std::vector<Positions>& a, const std::vector<Positions>& b) const;
  /// Distance: that of `from` to the reference, but at least 1e-9 body sizes. Energy: kinetic and
  /// elastic energy of the reference and its change of potential energy since the start, but at
  /// least 1e-9 times the energy m L² / (2 s²) of a body that moves its own size in a second.
  ErrorScale scale(const std::vector<Positions>& from, const StateSample& reference) const;
  Errors errors(const StateSample& state, const StateSample& reference,
                const ErrorScale& scale) const;
  /// Diagonal of the box around all bodies at the start [m].
  double size() const { return size_; }

 private:
  struct Edge {
    int body, from, to;
    double rest;  // [m]
  };
  void add_edges(int body, const Model& model);
  double largest_strain(const World& world) const;

  std::vector<Eigen::VectorXd> masses_;  // [kg]
  std::vector<Edge> edges_;
  double mass_ = 0.0;  // [kg]
  double size_ = 0.0;
  double start_potential_ = 0.0;  // [J]
};

/// Where the bodies would be after the last step without elasticity, contact and air: x + h v +
/// h² f / m [m]. It is where every implicit solver begins, and what it has to correct.
std::vector<Positions> inertial_prediction(const World& world);

}  // namespace pliant
