#pragma once

#include <string_view>
#include <vector>

#include "pliant/core/system/element_set.h"

namespace pliant {

/// Single coordinates of particles held near places by springs, E = 1/2 Σ k (x_a - target)²: plane
/// strain, and ends that turn but may warp. What fixes a particle holds all three of them.
class HeldCoordinates final : public ElementSet {
 public:
  struct Held {
    int particle, axis;
    double target;     ///< [m]
    double stiffness;  ///< > 0 [N/m]
  };

  void add(const Held& held) {
    held_.push_back(held);
    multipliers_.push_back(0.0);
  }
  const std::vector<Held>& held() const { return held_; }
  /// What one of them pulls with along its axis [N].
  static double pull(const Held& held, const Positions& x) {
    return held.stiffness * (held.target - x(held.axis, held.particle));
  }

  std::string_view name() const override { return "held_coordinates"; }
  int size() const override { return static_cast<int>(held_.size()); }
  double energy(const Positions& x) const override;
  void add_forces(const Positions& x, Forces& f) const override;
  void add_to_system(SystemMatrix& a) const override;
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;

 private:
  std::vector<Held> held_;
  std::vector<double> multipliers_;  // [N]
};

/// Forces that do not change as the body moves, E = -share Σ f · x. Unlike external forces they are
/// no part of a step's prediction, which in a step as long as a static one is far from anywhere.
class DeadLoads final : public ElementSet {
 public:
  explicit DeadLoads(Forces loads) : loads_(std::move(loads)) {}  ///< [N]
  void set_share(double share) { share_ = share; }

  std::string_view name() const override { return "dead_loads"; }
  int size() const override { return static_cast<int>(loads_.cols()); }
  double energy(const Positions& x) const override {
    return -share_ * loads_.cwiseProduct(x).sum();
  }
  void add_forces(const Positions&, Forces& f) const override { f += share_ * loads_; }
  void add_to_system(SystemMatrix&) const override {}
  void add_stiffness(const Positions&, Definiteness, StiffnessMatrix&) const override {}
  void reset_multipliers() override {}
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override {
    x += dt * dt * share_ * loads_ * inverse_mass.asDiagonal();
  }

 private:
  Forces loads_;
  double share_ = 0.0;
};

}  // namespace pliant
