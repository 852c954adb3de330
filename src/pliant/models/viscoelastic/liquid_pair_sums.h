#pragma once

#include "pliant/core/system/pair_sums.h"
#include "pliant/models/viscoelastic/blended_system.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {

/// What the device of a body's liquid sums for effects; where it fails, the CPU goes on.
class LiquidPairSums final : public PairSums {
 public:
  explicit LiquidPairSums(BlendedSystem& system) : system_(system) {}

  bool cohesion(Eigen::Matrix3Xd& sums) override {
    return tries([&](LiquidDevice& device, const LiquidState& s) { device.cohesion(s, sums); });
  }
  bool mixing(Eigen::Matrix3Xd& sums) override {
    return tries([&](LiquidDevice& device, const LiquidState& s) { device.mixing(s, sums); });
  }
  bool mixing_squares(const Eigen::Matrix3Xd& v, Eigen::VectorXd& sums) override {
    return tries([&](LiquidDevice& device, const LiquidState& s) {
      Particles moving;
      moving.x = s.particles.x;
      moving.v = v;
      moving.mass = s.particles.mass;
      device.mixing_squares({moving, s.beta, s.volumes, s.parts, s.materials, s.support}, sums);
    });
  }
  bool color_slope(Eigen::Matrix3Xd& sums) override {
    return tries([&](LiquidDevice& device, const LiquidState& s) { device.color_slope(s, sums); });
  }
  bool conduction(const Eigen::VectorXd& temperature, const Eigen::MatrixXd& conductivities,
                  Eigen::VectorXd& sums) override {
    return tries([&](LiquidDevice& device, const LiquidState& s) {
      device.conduction(s, temperature, conductivities, sums);
    });
  }

 private:
  template <class Sum>
  bool tries(const Sum& sum) {
    Liquid& liquid = system_.liquid;
    if (!liquid.has_device() || liquid.size() == 0) return false;
    try {
      sum(*liquid.device(), liquid.state(system_.particles, system_.beta));
    } catch (const DeviceFailure& failure) {
      liquid.device_failed(failure.what());
      return false;
    }
    return true;
  }

  BlendedSystem& system_;
};

}  // namespace pliant
