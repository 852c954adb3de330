#pragma once

#include "pliant/core/effect.h"

namespace pliant {

/// A uniform acceleration of every particle.
class GravityEffect final : public Effect {
 public:
  explicit GravityEffect(const Eigen::Vector3d& acceleration) : acceleration_(acceleration) {}
  std::string_view name() const override { return "gravity"; }
  void before_step(Body& body, double dt) override;
  bool join_resident_run(ResidentRun& run) const override {
    run.acceleration += acceleration_;
    return true;
  }
  double potential_energy(const Body& body) const override;
  const Eigen::Vector3d& acceleration() const { return acceleration_; }  ///< [m/s²]

 protected:
  void* offer(const std::type_info& type) override { return offer_as<GravityEffect>(this, type); }

 private:
  Eigen::Vector3d acceleration_;  // [m/s²]
};

EffectRegistry::Entry gravity_entry();

}  // namespace pliant
