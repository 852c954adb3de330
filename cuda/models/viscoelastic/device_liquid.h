#pragma once

#include <cmath>
#include <limits>

#include "cuda/models/viscoelastic/effect_sums.h"
#include "cuda/models/viscoelastic/liquid_passes.h"
#include "pliant/core/columns.h"
#include "pliant/models/viscoelastic/liquid.h"
#include "pliant/models/viscoelastic/liquid_device.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {

/// A liquid's forces by an executor, for a state that the CPU holds: uploads it and downloads what
/// comes of it.
template <class Executor>
class DeviceLiquid final : public LiquidDevice {
 public:
  void add_forces(const LiquidState& state, const Eigen::VectorXf& walls, Eigen::VectorXd& filling,
                  Forces& f) override {
    if (state.particles.size() == 0) return;
    place(state);
    upload(state);
    if (walls.size() > 0) executor_.upload(walls_, walls.data(), walls_.size());
    sort_particles();
    passes_.run(executor_, walls.size() > 0 ? walls_.data() : nullptr, filling_.data(),
                sums_.data());
    executor_.download(staged_filling_.data(), filling_, staged_filling_.size());
    executor_.download(staged_sums_.data(), sums_, staged_sums_.size());
    filling.resize(state.particles.size());
    for_each(state, [&](int i, std::size_t at) {
      filling[i] = static_cast<double>(staged_filling_[at]);
      const Float4 force = staged_sums_[at];
      f.col(i) += Eigen::Vector3d(force.x, force.y, force.z);
    });
  }

  void drag(const LiquidState& state, Eigen::VectorXd& sums) override {
    place(state);
    upload(state);
    const LiquidView view = sort_particles();
    if (heat_.size() != x_.size()) heat_.resize(x_.size());
    executor_.launch(view.grid.particles, DragSquares{view, heat_.data()});
    take_heat(state, state.support, sums);
  }

  void cohesion(const LiquidState& state, Eigen::Matrix3Xd& sums) override {
    const EffectView view = sort(state);
    executor_.launch(view.grid.particles, effect_sums::Cohesion{view, sums_.data()});
    take(state, state.support * state.support, sums);
  }

  void mixing(const LiquidState& state, Eigen::Matrix3Xd& sums) override {
    const double unit = state.particles.mass.maxCoeff();
    put_beside(state, [&](int i) { return Float2{own(state.particles.mass[i] / unit), 0.0f}; });
    const EffectView view = sort(state);
    executor_.launch(view.grid.particles, effect_sums::Mixing{view, sums_.data()});
    take(state, unit, sums);
  }

  void mixing_squares(const LiquidState& state, Eigen::VectorXd& sums) override {
    const double unit = state.particles.mass.maxCoeff();
    put_beside(state, [&](int i) { return Float2{own(state.particles.mass[i] / unit), 0.0f}; });
    const EffectView view = sort(state);
    executor_.launch(view.grid.particles, effect_sums::MixingSquares{view, heat_.data()});
    take_heat(state, unit, sums);
  }

  void color_slope(const LiquidState& state, Eigen::Matrix3Xd& sums) override {
    const EffectView view = sort(state);
    executor_.launch(view.grid.particles, effect_sums::ColorSlope{view, sums_.data()});
    take(state, 1.0 / state.support, sums);
  }

  void conduction(const LiquidState& state, const Eigen::VectorXd& temperature,
                  const Eigen::MatrixXd& conductivities, Eigen::VectorXd& sums) override {
    // Differences keep more digits than temperatures.
    const double mean = temperature.mean();
    put_beside(state, [&](int i) {
      return Float2{own(temperature[i] - mean),
                    static_cast<float>(state.parts[static_cast<std::size_t>(i)])};
    });
    const double largest = std::max(conductivities.maxCoeff(), 1e-300);
    const Eigen::MatrixXf between = (conductivities / largest).template cast<float>();
    between_.resize(static_cast<std::size_t>(between.size()));
    executor_.upload(between_, between.data(), between_.size());
    const EffectView view = sort(state);
    executor_.launch(view.grid.particles,
                     effect_sums::Conduction{view, between_.data(),
                                             static_cast<int>(between.rows()), heat_.data()});
    take_heat(state, state.support * largest, sums);
  }

 private:
  static constexpr int kGrain = 4096;
  // Of H, and of the farthest particle's distance from the centre: whichever is larger.
  static constexpr double kFinest = 1.0 / (1 << 22), kCoarsest = 1.0 / (1 << 29);
  static constexpr double kLargest = 1e-3;  // of H
  template <class T>
  using Array = typename Executor::template Array<T>;
  template <class T>
  using Staged = typename Executor::template Staged<T>;

  static float own(double value) { return static_cast<float>(value); }
  template <class Use>
  static void for_each(const LiquidState& state, const Use& use) {
    parallel_for(0, state.particles.size(), kGrain, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) use(i, static_cast<std::size_t>(i));
    });
  }

  const LiquidView& sort_particles() {
    passes_.sort(executor_, x_.data());
    return passes_.gather(executor_, GivenParticles{x_.data(), motion_.data()}, parts_.data());
  }
  /// The particles as they are now, by rank, with what put_beside() put beside them.
  EffectView sort(const LiquidState& state) {
    place(state);
    upload(state);
    const LiquidView& view = sort_particles();
    if (ranked_beside_.size() != x_.size()) ranked_beside_.resize(x_.size());
    if (heat_.size() != x_.size()) heat_.resize(x_.size());
    if (beside_.size() == x_.size()) {
      executor_.launch(view.grid.particles,
                       GatherBeside{view.grid.order, beside_.data(), ranked_beside_.data()});
    }
    return {view.grid, view.motion, ranked_beside_.data()};
  }
  template <class Of>
  void put_beside(const LiquidState& state, const Of& of) {
    staged_beside_.resize(static_cast<std::size_t>(state.particles.size()));
    for_each(state, [&](int i, std::size_t at) { staged_beside_[at] = of(i); });
    if (beside_.size() != staged_beside_.size()) beside_.resize(staged_beside_.size());
    executor_.upload(beside_, staged_beside_.data(), staged_beside_.size());
  }
  void take_heat(const LiquidState& state, double unit, Eigen::VectorXd& sums) {
    staged_heat_.resize(heat_.size());
    executor_.download(staged_heat_.data(), heat_, staged_heat_.size());
    sums.resize(state.particles.size());
    for_each(state, [&](int i, std::size_t at) { sums[i] = unit * staged_heat_[at]; });
  }
  void take(const LiquidState& state, double unit, Eigen::Matrix3Xd& sums) {
    executor_.download(staged_sums_.data(), sums_, staged_sums_.size());
    sums.resize(3, state.particles.size());
    for_each(state, [&](int i, std::size_t at) {
      const Float4 sum = staged_sums_[at];
      sums.col(i) = unit * Eigen::Vector3d(sum.x, sum.y, sum.z);
    });
  }

  /// The frame of the positions, and memory for them.
  void place(const LiquidState& state) {
    const Positions& x = state.particles.x;
    const Eigen::AlignedBox3d box = box_of(x);
    const Eigen::Vector3d extent = box.sizes();
    center_ = box.center();
    quantum_ = std::max(kFinest * state.support, kCoarsest * 0.5 * extent.maxCoeff());
    if (quantum_ > kLargest * state.support) {
      throw DeviceFailure("the particles lie too far apart for whole numbers of 32 bits");
    }
    const auto n = static_cast<std::size_t>(state.particles.size());
    if (x_.size() != n) {
      x_.resize(n);
      motion_.resize(n);
      parts_.resize(n);
      walls_.resize(n);
      filling_.resize(n);
      sums_.resize(n);
    }
    staged_x_.resize(n);
    staged_motion_.resize(n);
    staged_filling_.resize(n);
    staged_sums_.resize(n);
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
  }

  Executor executor_;
  LiquidPasses<Executor> passes_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double quantum_ = 1.0;  // [m]
  Array<Fixed> x_;
  Array<Float4> motion_, sums_;
  Array<int> parts_;
  Array<float> walls_, filling_, between_;
  Array<Float2> beside_, ranked_beside_;
  Array<double> heat_;
  Staged<Fixed> staged_x_;
  Staged<Float4> staged_motion_, staged_sums_;
  Staged<float> staged_filling_;
  Staged<Float2> staged_beside_;
  Staged<double> staged_heat_;
};

}  // namespace pliant
