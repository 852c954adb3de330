#include "pliant/effects/particles/xsph.h"

#include <algorithm>

#include "pliant/core/body.h"
#include "pliant/core/step/particle_series.h"
#include "pliant/core/system/neighbor_lists.h"
#include "pliant/core/system/pair_sums.h"
#include "pliant/math/error.h"
#include "pliant/math/sph_kernels.h"

namespace pliant {
namespace {
// Of the velocity's difference to its neighbours in one step: more would overshoot.
constexpr double kLargestShare = 0.5;
}  // namespace

bool XsphEffect::join_series(StepSeries& series) const {
  if (!series.particles) return false;
  series.particles->mixing = share(series.dt);
  return true;
}

double XsphEffect::share(double dt) const { return std::min(kLargestShare, rate_ * dt); }

void XsphEffect::after_step(Body& body, double dt) {
  Particles& p = body.particles();
  change_.resize(3, p.size());
  PairSums* device = blend_.pair_sums();
  if (device == nullptr || !device->mixing(change_)) sum_pairs(p);
  p.v += share(dt) * change_ * p.inverse_mass.asDiagonal();
}

void XsphEffect::sum_pairs(const Particles& p) {
  const SphKernels kernels(blend_.support());
  const NeighborLists& lists = blend_.neighbors(p.x);
  const Eigen::VectorXd &volumes = blend_.volumes(), &beta = blend_.beta();
  lists.for_each_point([&](int rank, int i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    lists.for_each_neighbor(rank, [&](int o) {
      // Equal for both, whatever their sizes.
      const double weight = std::min(beta[i], beta[o]) * std::min(p.mass[i], p.mass[o]) *
                            std::min(volumes[i], volumes[o]);
      sum -= weight * kernels.poly6((p.x.col(i) - p.x.col(o)).squaredNorm()) *
             (p.v.col(i) - p.v.col(o));
    });
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
