// What a liquid's viscosity takes of its motion. A step changes the kinetic energy by the work of
// its forces along the mean of the velocities before and after it, exactly: a pair that drags by
// d (vᵢ − vⱼ) loses h d (vᵢ − vⱼ)·(v̄ᵢ − v̄ⱼ), v̄ = (v + v')/2, however long the step is for d.
#include <algorithm>

#include "pliant/models/viscoelastic/liquid.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {

Eigen::VectorXd Liquid::viscous_losses(const Particles& particles, const Eigen::VectorXd& beta,
                                       double dt) {
  Eigen::VectorXd losses(size());
  if (device_ && device_viscous_losses(particles, beta, dt, losses)) return losses;
  const SphKernels kernels(support_);
  const NeighborLists& lists = neighbors(particles.x_start);
  const Positions& x = particles.x_start;
  const Eigen::Matrix3Xd &before = particles.v_start, &after = particles.v;
  lists.for_each_point([&](int rank, int i) {
    const auto part = [&](int k) { return parts_[static_cast<std::size_t>(k)]; };
    double sum = 0.0;
    lists.for_each_neighbor(rank, [&](int o) {
      const double weight = part(i) == part(o) ? std::max(beta[i], beta[o]) : 1.0;
      const double thickness = 0.5 * (material(i).viscosity + material(o).viscosity);
      const double drag = weight * (volumes_[i] * volumes_[o]) * (thickness / kSphLaplacian) *
                          kernels.viscosity_laplacian((x.col(i) - x.col(o)).norm());
      const Eigen::Vector3d slip = before.col(i) - before.col(o);
      sum += drag * slip.dot(slip + (after.col(i) - after.col(o)));
    });
    losses[i] = 0.25 * dt * sum;
  });
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
