#pragma once

#include <vector>

#include "cuda/models/viscoelastic/liquid_sums.h"
#include "pliant/models/viscoelastic/liquid.h"

namespace pliant {

/// A liquid's sums in the memory of an executor, from what lies there by particle.
template <class Executor>
class LiquidPasses {
 public:
  template <class T>
  using Array = typename Executor::template Array<T>;

  /// `parts` of particles; see ParticleGrid::shape().
  void shape(Executor& executor, int particles, const double* extent, double support,
             double quantum, const std::vector<LiquidConstants>& constants) {
    grid_.shape(particles, extent, support, quantum);
    const auto n = static_cast<std::size_t>(particles);
    if (ranked_x_.size() < n) {
      ranked_x_.resize(n);
      ranked_motion_.resize(n);
      ranked_parts_.resize(n);
      pressure_.resize(n);
    }
    if (constants_.size() < constants.size()) constants_.resize(constants.size());
    executor.upload(constants_, constants.data(), constants.size());
    has_parts_ = constants.size() > 1;
    support_ = static_cast<float>(support);
  }

  /// By their positions.
  void sort(Executor& executor, const Fixed* x) { grid_.build(executor, x); }

  /// In the order of the last sort(): GivenParticles or MovingParticles, and their parts.
  template <class Particles>
  const LiquidView& gather(Executor& executor, const Particles& particles, const int* parts) {
    view_.grid = grid_.view();
    view_.grid.x = ranked_x_.data();
    view_.motion = ranked_motion_.data();
    view_.parts = has_parts_ ? ranked_parts_.data() : nullptr;
    view_.constants = constants_.data();
    view_.pressure = pressure_.data();
    view_.support = support_;
    executor.launch(
        view_.grid.particles,
        GatherParticles<Particles>{view_.grid.order, particles, has_parts_ ? parts : nullptr,
                                   ranked_x_.data(), ranked_motion_.data(), ranked_parts_.data()});
    return view_;
  }

  /// The liquid's forces on what was gathered; `walls` may be null.
  void run(Executor& executor, const float* walls, float* filling, Float4* forces) {
    executor.launch(view_.grid.particles, FillLiquid{view_, walls, filling});
    executor.launch(view_.grid.particles, PushLiquid{view_, forces});
  }

  const LiquidConstants* constants() const { return constants_.data(); }

 private:
  ParticleGrid<Executor> grid_;
  Array<Fixed> ranked_x_;
  Array<Float4> ranked_motion_;
  Array<int> ranked_parts_;
  Array<float> pressure_;
  Array<LiquidConstants> constants_;
  bool has_parts_ = false;
  float support_ = 1.0f;
  LiquidView view_;
};

inline std::vector<LiquidConstants> liquid_constants(const std::vector<LiquidMaterial>& materials) {
  std::vector<LiquidConstants> constants;
  for (const LiquidMaterial& m : materials) {
    constants.push_back({static_cast<float>(m.bulk()), static_cast<float>(m.viscosity)});
  }
  return constants;
}

}  // namespace pliant
