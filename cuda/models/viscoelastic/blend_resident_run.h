#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "cuda/models/viscoelastic/effect_sums.h"
#include "cuda/models/viscoelastic/liquid_passes.h"
#include "cuda/models/viscoelastic/part_momentum.h"
#include "cuda/models/viscoelastic/resident_effects.h"
#include "cuda/models/viscoelastic/wall_sums.h"
#include "cuda/solvers/resident_run/resident_forces.h"
#include "pliant/core/step/particle_resident_run.h"
#include "pliant/models/viscoelastic/blended_system.h"

namespace pliant {

/// What ViscoelasticModel and the effects of liquids do in a resident run: the liquid's forces
/// between particles and at walls, surface tension, XSPH, and the momentum of what holds together.
/// beta and clusters stay as they are.
template <class Executor>
class BlendResidentRun final : public ResidentForces<Executor> {
 public:
  bool can_take(const ProjectiveSystem& system, const ResidentRun& run,
                double quantum) const override;
  void begin(const ProjectiveSystem& system, const ResidentRun& run, const PackedSystem& packed,
             const ResidentFrame& frame) override;
  void upload(Executor& executor, const StepArrays& arrays, ResidentArrays& resident) override;
  void before_substep(Executor& executor) override;
  void add_reactions(Executor& executor, float share, float* sums) override;
  void after_substep(Executor& executor) override;
  bool watches_speed() const override { return rules_.flows; }
  bool goes_on(float fastest) const override {
    const double speed = speed_ * std::sqrt(static_cast<double>(fastest));
    return speed > rules_.least_speed && speed <= rules_.most_speed;
  }

 private:
  static constexpr double kCoarsest = 1e-3;  // quanta, of H
  static constexpr int kGrain = 4096;
  template <class T>
  using Array = typename Executor::template Array<T>;
  template <class T>
  using Staged = typename Executor::template Staged<T>;

  struct Part {
    bool keeps_momentum = true;  ///< nothing holds it
    double weight = 0.0;         ///< Σ M/h² [N/m]
  };
  bool mixes() const { return rules_.melts && rules_.mixing > 0.0; }
  bool coheres() const { return rules_.melts && rules_.cohesion > 0.0; }
  const int* parts() const { return materials_.size() > 1 ? part_numbers_.data() : nullptr; }
  void find_parts(const BlendedSystem& system, double dt);
  template <class T>
  static void put(Executor& executor, Array<T>& array, const Staged<T>& values) {
    if (array.size() != values.size()) array.resize(values.size());
    executor.upload(array, values.data(), values.size());
  }
  void reserve(int particles);
  WallForces wall_forces() const;
  void gather(Executor& executor);
  EffectView effect_view() const;
  void keep_momentum(Executor& executor);
  void mix(Executor& executor);

  ParticleResidentRun rules_;
  ResidentFrame frame_ = {};
  double dt_ = 0.0, speed_ = 0.0;  // of a substep [s], of one quantum in it [m/s]
  double support_ = 1.0;           // [m]
  double unit_mass_ = 1.0;         // [kg]
  int obstacles_ = 0;              // that it looks at
  bool keeps_momentum_ = false;
  std::vector<Part> body_parts_;
  std::vector<LiquidConstants> materials_;
  StepArrays arrays_;
  ResidentArrays resident_;
  LiquidPasses<Executor> passes_;
  LiquidView view_;
  Staged<Float2> staged_beside_, staged_mass_;
  Staged<int> staged_parts_;
  Array<Float2> beside_, mass_, ranked_mass_;  // V/H³ and beta; m in the largest one
  Array<int> part_numbers_;
  Array<Float4> pulls_, sums_, means_;
  Array<float> filled_, filling_;
  Array<double> missing_;
};

template <class Executor>
bool BlendResidentRun<Executor>::can_take(const ProjectiveSystem& base, const ResidentRun& run,
                                          double quantum) const {
  const auto* system = dynamic_cast<const BlendedSystem*>(&base);
  if (system == nullptr) return false;
  if (!run.particles->flows) return true;
  // Cubes of the grid are whole numbers of quanta, and those of 32 bits.
  const double support = system->liquid.support();
  if (quantum > kCoarsest * support || support > quantum * (1 << 30)) return false;
  return !run.particles->meets_walls ||
         std::none_of(run.obstacles->begin(), run.obstacles->end(),
                      [](const Obstacle& obstacle) { return obstacle.liquid; });
}

template <class Executor>
void BlendResidentRun<Executor>::begin(const ProjectiveSystem& base, const ResidentRun& run,
                                       const PackedSystem& packed, const ResidentFrame& frame) {
  const auto& system = static_cast<const BlendedSystem&>(base);
  const LiquidState state = system.liquid.state(system.particles, system.beta);
  rules_ = *run.particles;
  frame_ = frame;
  dt_ = run.dt;
  speed_ = frame.quantum / run.dt;
  support_ = state.support;
  obstacles_ = rules_.meets_walls ? static_cast<int>(run.obstacles->size()) : 0;
  materials_ = liquid_constants(state.materials);
  unit_mass_ = system.particles.mass.maxCoeff();
  find_parts(system, run.dt);
  const std::size_t n = packed.order.size();
  staged_beside_.resize(n);
  staged_mass_.resize(n);
  staged_parts_.resize(n);
  const double cubed = support_ * support_ * support_;
  parallel_for(0, static_cast<int>(n), kGrain, [&](int first, int end) {
    for (int k = first; k < end; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const int i = packed.order[at];
      staged_beside_[at] = {static_cast<float>(state.volumes[i] / cubed),
                            static_cast<float>(state.beta[i])};
      staged_mass_[at] = {static_cast<float>(system.particles.mass[i] / unit_mass_), 0.0f};
      staged_parts_[at] = state.parts[static_cast<std::size_t>(i)];
    }
  });
}

template <class Executor>
void BlendResidentRun<Executor>::find_parts(const BlendedSystem& system, double dt) {
  // Attachments pull from outside.
  keeps_momentum_ =
      system.solid().clusters() > 0 &&
      std::all_of(system.elements.begin(), system.elements.end(), [&](const auto& set) {
        return set.get() == &system.solid() || set->size() == 0;
      });
  body_parts_.assign(materials_.size(), Part());
  for (int i = 0; i < system.particles.size(); ++i) {
    const int number = system.liquid.parts()[static_cast<std::size_t>(i)];
    Part& part = body_parts_[static_cast<std::size_t>(number)];
    part.weight += system.particles.mass[i] / (dt * dt);
    part.keeps_momentum &= !system.particles.is_fixed(i);
  }
}

template <class Executor>
void BlendResidentRun<Executor>::reserve(int particles) {
  const auto n = static_cast<std::size_t>(particles);
  const auto runs = static_cast<std::size_t>(particles / SumMissing::kThreads + 1);
  if (pulls_.size() != n) {
    for (Array<Float4>* array : {&pulls_, &sums_}) array->resize(n);
    for (Array<float>* array : {&filled_, &filling_}) array->resize(n);
    ranked_mass_.resize(n);
    missing_.resize(runs * SumMissing::kNumbers);
  }
  means_.resize(materials_.size());
}

template <class Executor>
void BlendResidentRun<Executor>::upload(Executor& executor, const StepArrays& arrays,
                                        ResidentArrays& resident) {
  reserve(arrays.particles);
  put(executor, beside_, staged_beside_);
  put(executor, mass_, staged_mass_);
  put(executor, part_numbers_, staged_parts_);
  resident.pulls = rules_.flows ? pulls_.data() : nullptr;
  arrays_ = arrays;
  resident_ = resident;
  if (!rules_.flows) return;
  passes_.shape(executor, arrays.particles, frame_.extent.data(), support_, frame_.quantum,
                materials_);
  // Later each substep leaves this behind.
  if (mixes()) passes_.sort(executor, resident_.now);
}

template <class Executor>
void BlendResidentRun<Executor>::gather(Executor& executor) {
  const MovingParticles particles = {resident_.now, resident_.velocity, beside_.data(),
                                     static_cast<float>(speed_)};
  view_ = passes_.gather(executor, particles, parts());
}

template <class Executor>
EffectView BlendResidentRun<Executor>::effect_view() const {
  return {view_.grid, view_.motion, ranked_mass_.data()};
}

template <class Executor>
WallForces BlendResidentRun<Executor>::wall_forces() const {
  const WallsView walls = {resident_.obstacles, obstacles_, static_cast<float>(frame_.quantum),
                           static_cast<float>(support_)};
  const MovingParticles particles = {resident_.now, resident_.velocity, beside_.data(),
                                     static_cast<float>(speed_)};
  return {walls, particles, parts(), passes_.constants(), filled_.data(), filling_.data()};
}

template <class Executor>
void BlendResidentRun<Executor>::before_substep(Executor& executor) {
  if (!rules_.flows) return;
  const int n = arrays_.particles;
  if (!mixes()) passes_.sort(executor, resident_.now);
  gather(executor);
  const WallForces walls = wall_forces();
  if (obstacles_ > 0) executor.launch(n, FillWalls{walls.walls, resident_.now, filled_.data()});
  passes_.run(executor, obstacles_ > 0 ? filled_.data() : nullptr, filling_.data(), pulls_.data());
  if (obstacles_ > 0) executor.launch(n, PushWalls{walls, pulls_.data()});
  if (!coheres()) return;
  executor.launch(n, effect_sums::Cohesion{effect_view(), sums_.data()});
  const double factor = support_ * support_ * rules_.cohesion;
  executor.launch(n, AddScaled{sums_.data(), static_cast<float>(factor), pulls_.data()});
}

template <class Executor>
void BlendResidentRun<Executor>::add_reactions(Executor& executor, float share, float* sums) {
  if (obstacles_ == 0) return;
  const int n = arrays_.particles, block = arrays_.block;
  executor.launch_blocks((n + block - 1) / block, block, block * kReactionNumbers * resident_.slots,
                         SumWallReactions{wall_forces(), n, block, resident_.slots, share, sums});
}

template <class Executor>
void BlendResidentRun<Executor>::after_substep(Executor& executor) {
  if (keeps_momentum_) keep_momentum(executor);
  if (mixes()) mix(executor);
}

template <class Executor>
void BlendResidentRun<Executor>::keep_momentum(Executor& executor) {
  const int n = arrays_.particles;
  const int runs = (n + SumMissing::kThreads - 1) / SumMissing::kThreads;
  if (resident_.slots > 0) executor.launch(n, FindPressing{resident_});
  for (int part = 0; part < static_cast<int>(body_parts_.size()); ++part) {
    const Part& own = body_parts_[static_cast<std::size_t>(part)];
    if (!own.keeps_momentum || own.weight == 0.0) continue;
    executor.launch_blocks(runs, SumMissing::kThreads, SumMissing::kSharedFloats,
                           SumMissing{resident_, n, parts(), part, missing_.data()});
    executor.launch_blocks(1, MeanMissing::kThreads, SumMissing::kSharedFloats,
                           MeanMissing{missing_.data(), runs, own.weight, means_.data() + part});
  }
  executor.launch(n, TakeMissing{resident_, parts(), means_.data()});
}

template <class Executor>
void BlendResidentRun<Executor>::mix(Executor& executor) {
  const int n = arrays_.particles;
  passes_.sort(executor, resident_.now);
  gather(executor);
  executor.launch(n, GatherBeside{view_.grid.order, mass_.data(), ranked_mass_.data()});
  executor.launch(n, effect_sums::Mixing{effect_view(), sums_.data()});
  // m = (M/h²) h², and velocities are kept times h.
  const double factor = rules_.mixing * unit_mass_ / (frame_.quantum * dt_);
  executor.launch(n, MixVelocities{sums_.data(), arrays_.mobility, resident_.now,
                                   static_cast<float>(factor), resident_.velocity});
}

}  // namespace pliant
