#pragma once

#include <vector>

#include "pliant/core/body/blended_particles.h"
#include "pliant/core/system/neighbor_lists.h"
#include "pliant/effects/contact/pair_detection.h"

namespace pliant {

/// Finds where bodies of particles touch each other and where one touches itself: particles are
/// balls of their spacing, or of the thickness where that is more, and those of what is solid that
/// nothing binds keep out of each other. What is liquid has its pressure.
class ParticleContactDetection final : public PairDetection {
 public:
  /// `blend` outlives this.
  ParticleContactDetection(BlendedParticles& blend, const Options& options);
  void find(const Particles& particles, double dt, std::vector<PairContact>& contacts) override;
  int most_particles() const override { return 2; }

 private:
  /// Distance that two particles keep [m].
  double least(int i, int j) const { return 0.5 * (sizes_[i] + sizes_[j]); }
  /// How far two may be apart at the start of the step and touch in it [m].
  double reach(const Particles& particles) const;
  void add(const Particles& particles, int i, int j, double dt,
           std::vector<PairContact>& contacts) const;

  BlendedParticles& blend_;
  Options options_;
  Eigen::VectorXd sizes_;  // of the balls [m]
  NeighborLists lists_;
};

}  // namespace pliant
