#pragma once

#include <cmath>
#include <limits>

#include "cuda/models/viscoelastic/liquid_sums.h"
#include "pliant/core/parallel.h"
#include "pliant/models/viscoelastic/liquid.h"
#include "pliant/models/viscoelastic/liquid_device.h"

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

  /// Positions with V/H³, velocities with beta, and parts of particles; `walls` may be null.
  void run(Executor& executor, const Fixed* x, const Float4* motion, const int* parts,
           const float* walls, float* filling, Float4* forces) {
    grid_.build(executor, x);
    LiquidView view;
    view.grid = grid_.view();
    view.grid.x = ranked_x_.data();
    view.motion = ranked_motion_.data();
    view.parts = has_parts_ ? ranked_parts_.data() : nullptr;
    view.constants = constants_.data();
    view.pressure = pressure_.data();
    view.support = support_;
    const int n = view.grid.particles;
    executor.launch(n,
                    GatherParticles{view.grid.order, x, motion, has_parts_ ? parts : nullptr,
                                    ranked_x_.data(), ranked_motion_.data(), ranked_parts_.data()});
    executor.launch(n, FillLiquid{view, walls, filling});
    executor.launch(n, PushLiquid{view, forces});
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
};

inline std::vector<LiquidConstants> liquid_constants(const std::vector<LiquidMaterial>& materials) {
  std::vector<LiquidConstants> constants;
  for (const LiquidMaterial& m : materials) {
    constants.push_back({static_cast<float>(m.sound_speed * m.sound_speed * m.density),
                         static_cast<float>(m.viscosity)});
  }
  return constants;
}

/// A liquid's forces by an executor, for a state that the CPU holds: uploads it and downloads what
/// comes of it.
template <class Executor>
class DeviceLiquid final : public LiquidDevice {
 public:
  void add_forces(const LiquidState& state, Eigen::VectorXd& filling, Forces& f) override {
    if (state.particles.size() == 0) return;
    place(state);
    upload(state);
    passes_.run(executor_, x_.data(), motion_.data(), parts_.data(),
                state.walls.size() > 0 ? walls_.data() : nullptr, filling_.data(), forces_.data());
    executor_.download(staged_filling_.data(), filling_, staged_filling_.size());
    executor_.download(staged_forces_.data(), forces_, staged_forces_.size());
    filling.resize(state.particles.size());
    parallel_for(0, state.particles.size(), kGrain, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        const auto at = static_cast<std::size_t>(i);
        filling[i] = static_cast<double>(staged_filling_[at]);
        const Float4 force = staged_forces_[at];
        f.col(i) += Eigen::Vector3d(force.x, force.y, force.z);
      }
    });
  }

 private:
  static constexpr int kGrain = 4096;
  // Of H, and of the farthest particle's distance from the centre: whichever is larger.
  static constexpr double kFinest = 1.0 / (1 << 22), kCoarsest = 1.0 / (1 << 29);
  template <class T>
  using Array = typename Executor::template Array<T>;
  template <class T>
  using Staged = typename Executor::template Staged<T>;

  /// The frame of the positions, and memory for them.
  void place(const LiquidState& state) {
    const Positions& x = state.particles.x;
    const Eigen::Vector3d low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
    const Eigen::Vector3d extent = high - low;
    center_ = 0.5 * (low + high);
    quantum_ = std::max(kFinest * state.support, kCoarsest * 0.5 * extent.maxCoeff());
    const auto n = static_cast<std::size_t>(state.particles.size());
    if (x_.size() != n) {
      x_.resize(n);
      motion_.resize(n);
      parts_.resize(n);
      walls_.resize(n);
      filling_.resize(n);
      forces_.resize(n);
    }
    staged_x_.resize(n);
    staged_motion_.resize(n);
    staged_filling_.resize(n);
    staged_forces_.resize(n);
    passes_.shape(executor_, state.particles.size(), extent.data(), state.support, quantum_,
                  liquid_constants(state.materials));
  }

  void upload(const LiquidState& state) {
    const Particles& p = state.particles;
    const double cubed = state.support * state.support * state.support;
    parallel_for(0, p.size(), kGrain, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        const Eigen::Vector3d at = (p.x.col(i) - center_) / quantum_;
        const auto whole = [&](int k) { return static_cast<int>(std::lrint(at[k])); };
        const auto number = static_cast<std::size_t>(i);
        staged_x_[number] = {whole(0), whole(1), whole(2),
                             static_cast<float>(state.volumes[i] / cubed)};
        const Eigen::Vector3f v = p.v.col(i).cast<float>();
        staged_motion_[number] = {v[0], v[1], v[2], static_cast<float>(state.beta[i])};
      }
    });
    executor_.upload(x_, staged_x_.data(), staged_x_.size());
    executor_.upload(motion_, staged_motion_.data(), staged_motion_.size());
    executor_.upload(parts_, state.parts.data(), state.parts.size());
    if (state.walls.size() > 0) executor_.upload(walls_, state.walls.data(), walls_.size());
  }

  Executor executor_;
  LiquidPasses<Executor> passes_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double quantum_ = 1.0;  // [m]
  Array<Fixed> x_;
  Array<Float4> motion_, forces_;
  Array<int> parts_;
  Array<float> walls_, filling_;
  Staged<Fixed> staged_x_;
  Staged<Float4> staged_motion_, staged_forces_;
  Staged<float> staged_filling_;
};

}  // namespace pliant
