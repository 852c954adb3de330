#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/effects/contact/contact_sweeps.h"
#include "pliant/effects/self_contact/self_contact_pairs.h"
#include "pliant/effects/wetness/wet_contact.h"

namespace pliant {

/// Finds where a body touches itself.
class PairDetection {
 public:
  struct Options {
    double thickness = 0.002;  ///< that is kept between surfaces [m]
    double margin = 0.0005;    ///< contacts open by less are found too [m]
    double friction = 0.5;     ///< Coulomb coefficient of the contacts
  };

  static constexpr double kMaxPushOutSpeed = 1.0;  ///< at which overlaps are opened [m/s]

  virtual ~PairDetection() = default;
  /// Replaces `contacts` by those of a step of length `dt` [s] from x_start to x, in an order that
  /// no thread changes.
  virtual void find(const Particles& particles, double dt, std::vector<PairContact>& contacts) = 0;
  /// Whether what the iterations moved has to be looked at again: a sheet that passed through
  /// itself does not know its sides any more, a solid does.
  virtual bool is_final() const { return true; }
  /// Adds those that it finds where it looks again.
  virtual void find_again(const Particles& /*particles*/, double /*dt*/,
                          std::vector<PairContact>& /*contacts*/) {}
  /// Whether nothing passes on the straight path to `x` from the start of the last find(). Else x
  /// goes back to where it may come, without moving fixed particles, and `contacts` become those of
  /// the rest of the path.
  virtual bool limit_displacement(const Particles& /*particles*/, double /*dt*/, Positions& /*x*/,
                                  std::vector<PairContact>& /*contacts*/) {
    return true;
  }
  /// Water at the particles from now on; `wet` outlives this.
  virtual void set_wetness(const WetContact* /*wet*/) {}
  /// Where it searches from now on, of what can be searched for there. Throws DeviceFailure where
  /// that cannot be, and goes on with the CPU.
  virtual void search_on_gpu(bool /*on_gpu*/) {}
  /// Why it went back to the CPU since this was last asked; empty: it did not.
  virtual std::string take_device_failure() { return {}; }
  /// That searches have taken since this was last asked [s].
  virtual double take_search_seconds() { return 0.0; }
  /// That carry one of its pairs, at the most.
  virtual int most_particles() const { return PairContact::kParticles; }
  /// How many contacts a body may have with itself. A body with more has fallen into a heap whose
  /// places are all nearer to each other than its thickness. No list that a detection fills has
  /// more than one above that number, however many there are.
  virtual std::size_t most_contacts() const { return std::numeric_limits<std::size_t>::max(); }
  /// That is kept between layers of a sheet [m]; 0 of what is none.
  virtual double sheet_thickness() const { return 0.0; }
  /// Over all pairs, for each iteration of the solver.
  virtual int sweeps() const { return kMaxSweeps; }
};

}  // namespace pliant
