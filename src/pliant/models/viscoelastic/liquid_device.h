#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "pliant/core/particles.h"

namespace pliant {

struct LiquidMaterial;

/// What a liquid's forces depend on.
struct LiquidState {
  const Particles& particles;
  const Eigen::VectorXd& beta;
  const Eigen::VectorXd& volumes;  ///< at rest [m³]
  const std::vector<int>& parts;   ///< of particles
  const std::vector<LiquidMaterial>& materials;
  double support;                ///< H [m]
  const Eigen::VectorXf& walls;  ///< what walls fill about each particle; empty: nothing
};

/// Computes the forces between a liquid's particles elsewhere than Liquid does it itself, in single
/// precision. Throws DeviceFailure, and then has changed nothing.
class LiquidDevice {
 public:
  virtual ~LiquidDevice() = default;
  /// Adds to `f` [N] and sets ψ of each particle.
  virtual void add_forces(const LiquidState& state, Eigen::VectorXd& filling, Forces& f) = 0;
};

/// On the GPU. Throws DeviceFailure where there is none.
std::unique_ptr<LiquidDevice> make_cuda_liquid();

}  // namespace pliant
