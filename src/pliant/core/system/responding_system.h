#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

/// A system whose particles follow a few coordinates q of unit mass, x = X + U q, as those of a
/// reduced body do. Moved together with other bodies, it makes a step of its own first, which stays
/// open: until it is closed its particles answer forces of other bodies linearly, x = x₀ + R f, and
/// conditions of its own, as contact with obstacles, hold on.
class RespondingSystem {
 public:
  virtual ~RespondingSystem() = default;
  /// Whether its steps stay open from now on.
  virtual void keep_open(bool is_open) = 0;

  /// Where its particles are at the open step's end, under forces `f` [N] of other bodies that act
  /// all through the step: 3 x n each [m].
  virtual void move(const Forces& f, Positions& x) = 0;
  /// How far forces v [N] move the particles, without conditions of its own: R v, which takes their
  /// place [m]. Forces act on the particles `at` alone: other columns are neither read nor changed.
  virtual void respond(const std::vector<int>& at, Eigen::Ref<Forces> v) = 0;
  /// The most that a force on this particle moves it [m/N].
  virtual double answer(int particle) = 0;

  /// R⁻¹ of the coordinates, r x r; valid until the next step begins.
  virtual const Eigen::MatrixXd& inverse_response() = 0;

  /// Closes the step of `dt` [s] under the forces of the last move(), of which it went `share`.
  virtual void close(double share, double dt) = 0;
  /// Of a closed step: velocities of the coordinates. Impulses change them by Uᵀ.
  virtual Eigen::VectorXd& momenta() = 0;
  /// Adds Uᵀ of `weight` times a force on a particle, in each axis, to `rows`, r x 3.
  virtual void add_rows(int particle, double weight, Eigen::Ref<Eigen::MatrixXd> rows) const = 0;
  /// Impulses of other bodies changed the momenta by `impulses` [kg^½ m/s] in all: conditions of
  /// its own take part, and the particles' velocities follow.
  virtual void take_impulses(const Eigen::VectorXd& impulses, double dt) = 0;
};

}  // namespace pliant
