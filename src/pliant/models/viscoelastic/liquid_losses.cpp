// What a liquid's viscosity takes of its motion. A step changes the kinetic energy by the work of
// its forces along the mean of the velocities before and after it, exactly: a pair that drags by
// d (vᵢ − vⱼ) loses h d (vᵢ − vⱼ)·(v̄ᵢ − v̄ⱼ), v̄ = (v + v')/2, however long the step is for d.
#include "pliant/core/parallel/parallel.h"
#include "pliant/models/viscoelastic/liquid.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {
constexpr int kGrain = 256;
}  // namespace

Eigen::VectorXd Liquid::viscous_losses(const Particles& particles, const Eigen::VectorXd& beta,
                                       double dt) {
  Eigen::VectorXd losses(size());
  if (device_ && device_viscous_losses(particles, beta, dt, losses)) return losses;
  const NeighborLists& lists = neighbors(particles.x_start);
  gather(particles.x_start, particles.v_start, beta);
  later_.setZero(4, size());
  sums_.resize(size());
  lists.for_each_point([&](int rank, int i) { later_.col(rank).head<3>() = particles.v.col(i); });
  const LiquidSums sums = {lists, ranked_.data(), SphKernels(support_)};
  parallel_for(0, size(), kGrain,
               [&](int begin, int end) { sums.lose(begin, end, later_.data(), sums_.data()); });
  lists.for_each_point([&](int rank, int i) { losses[i] = 0.25 * dt * sums_[rank]; });
  return losses;
}

bool Liquid::device_viscous_losses(const Particles& particles, const Eigen::VectorXd& beta,
                                   double dt, Eigen::VectorXd& losses) {
  // u·w = (|u + w|² − |u − w|²)/4 with u = v and w = v + v': the device sums squares.
  Particles moving;
  moving.x = particles.x_start;
  moving.mass = particles.mass;
  Eigen::VectorXd less;
  try {
    moving.v = 2.0 * particles.v_start + particles.v;
    device_->drag(state(moving, beta), losses);
    moving.v = -particles.v;
    device_->drag(state(moving, beta), less);
  } catch (const DeviceFailure& failure) {
    device_failed(failure.what());
    return false;
  }
  losses = 0.0625 * dt * (losses - less);
  return true;
}

}  // namespace pliant
