#include "pliant/effects/particles/xsph.h"

#include <algorithm>

#include "pliant/core/body.h"
#include "pliant/core/step/particle_resident_run.h"
#include "pliant/core/system/neighbor_lists.h"
#include "pliant/core/system/pair_sums.h"
#include "pliant/laws/sph_pairs.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {
// Of the velocity's difference to its neighbours in one step: more would overshoot.
constexpr double kLargestShare = 0.5;
}  // namespace

double XsphEffect::weight(const Particles& p, const SphKernels<double>& kernels, int i,
                          int o) const {
  const Eigen::VectorXd &volumes = blend_.volumes(), &beta = blend_.beta();
  const double weight = xsph_weight(beta[i], beta[o], p.mass[i], p.mass[o], volumes[i], volumes[o]);
  return weight * kernels.poly6((p.x.col(i) - p.x.col(o)).squaredNorm());
}

bool XsphEffect::join_resident_run(ResidentRun& run) const {
  if (!run.particles) return false;
  run.particles->mixing = share(run.dt);
  return true;
}

double XsphEffect::share(double dt) const { return std::min(kLargestShare, rate_ * dt); }

void XsphEffect::after_step(Body& body, double dt) {
  Particles& p = body.particles();
  change_.resize(3, p.size());
  PairSums* device = blend_.pair_sums();
  if (device == nullptr || !device->mixing(change_)) sum_pairs(p);
  if (!blend_.keeps_losses()) {
    p.v += share(dt) * change_ * p.inverse_mass.asDiagonal();
    return;
  }
  const Eigen::Matrix3Xd before = p.v;
  p.v += share(dt) * change_ * p.inverse_mass.asDiagonal();
  blend_.note_motion_losses(share(dt) * losses(p, before));
}

Eigen::VectorXd XsphEffect::losses(const Particles& p, const Eigen::Matrix3Xd& before) {
  Eigen::VectorXd sums(p.size()), less;
  PairSums* device = blend_.pair_sums();
  // u·w = (|u + w|² − |u − w|²)/4 with u = v and w = v + v'.
  if (device != nullptr && device->mixing_squares(2.0 * before + p.v, sums) &&
      device->mixing_squares(-p.v, less)) {
    return 0.0625 * (sums - less);
  }
  const SphKernels kernels(blend_.support());
  const NeighborLists& lists = blend_.neighbors(p.x);
  lists.for_each_point([&](int rank, int i) {
    double sum = 0.0;
    lists.for_each_neighbor(rank, [&](int o) {
      const Eigen::Vector3d apart = before.col(i) - before.col(o);
      sum += weight(p, kernels, i, o) * apart.dot(apart + (p.v.col(i) - p.v.col(o)));
    });
    sums[i] = 0.25 * sum;
  });
  return sums;
}

void XsphEffect::sum_pairs(const Particles& p) {
  const SphKernels kernels(blend_.support());
  const NeighborLists& lists = blend_.neighbors(p.x);
  lists.for_each_point([&](int rank, int i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    lists.for_each_neighbor(
        rank, [&](int o) { sum -= weight(p, kernels, i, o) * (p.v.col(i) - p.v.col(o)); });
    change_.col(i) = sum;
  });
}

EffectRegistry::Entry xsph_entry() {
  return {"xsph",
          "velocities of liquid neighbours draw near each other: less jitter, momentum kept",
          {number_parameter("rate", "1/s", "10", 0.0, 1e6,
                            "share of the difference to the neighbours lost per second")},
          {"viscoelastic"},
          [](const Parameters& given, const EffectSite& site) {
            auto* blend = site.body.model->find<BlendedParticles>();
            if (blend == nullptr) throw InputError("effect 'xsph' needs a body of particles");
            return std::make_unique<XsphEffect>(*blend, given.number("rate"));
          }};
}

}  // namespace pliant
