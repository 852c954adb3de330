#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

struct LiquidMaterial;

/// What sums over particles depend on.
struct LiquidState {
  const Particles& particles;
  const Eigen::VectorXd& beta;
  const Eigen::VectorXd& volumes;  ///< at rest [m³]
  const std::vector<int>& parts;   ///< of particles
  const std::vector<LiquidMaterial>& materials;
  double support;  ///< H [m]
};

/// Computes the sums over a liquid's neighbours elsewhere than Liquid and the effects do it
/// themselves, in single precision. Throws DeviceFailure, and then has changed nothing.
class LiquidDevice {
 public:
  virtual ~LiquidDevice() = default;
  /// Adds pressure and viscosity to `f` [N] and sets ψ of each particle. `walls`: what these fill
  /// about each; empty: nothing.
  virtual void add_forces(const LiquidState& state, const Eigen::VectorXf& walls,
                          Eigen::VectorXd& filling, Forces& f) = 0;
  /// Σⱼ d |vᵢ − vⱼ|² of each particle, with the viscous force of a pair, d (vⱼ − vᵢ) [W].
  virtual void drag(const LiquidState& state, Eigen::VectorXd& sums) = 0;
  // As PairSums.
  virtual void cohesion(const LiquidState& state, Eigen::Matrix3Xd& sums) = 0;
  virtual void mixing(const LiquidState& state, Eigen::Matrix3Xd& sums) = 0;
  virtual void mixing_squares(const LiquidState& state, Eigen::VectorXd& sums) = 0;
  virtual void color_slope(const LiquidState& state, Eigen::Matrix3Xd& sums) = 0;
  virtual void conduction(const LiquidState& state, const Eigen::VectorXd& temperature,
                          const Eigen::MatrixXd& conductivities, Eigen::VectorXd& sums) = 0;
};

/// On the GPU. Throws DeviceFailure where there is none.
std::unique_ptr<LiquidDevice> make_cuda_liquid();

/// What the CUDA backend makes it by (solvers/device/cuda_library.h).
using MakeCudaLiquid = void(std::unique_ptr<LiquidDevice>& liquid);
constexpr const char* kMakeCudaLiquid = "pliant_cuda_liquid";

}  // namespace pliant
