#include "pliant/effects/particles/surface_tension.h"

#include <algorithm>

#include "pliant/core/body.h"
#include "pliant/core/step/particle_resident_run.h"
#include "pliant/core/system/neighbor_lists.h"
#include "pliant/core/system/pair_sums.h"
#include "pliant/laws/sph_pairs.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {
// Of the integral's surface energy particles half a support's distance apart have so much, since
// none are nearer to each other (measured: SurfaceTension.HasTheEnergyOfTheSurfaceItMakes).
constexpr double kDiscrete = 0.8;
}  // namespace

double SurfaceTensionEffect::strength() const {
  return 1024.0 / 63.0 / kDiscrete * tension_ / blend_.support();
}

void SurfaceTensionEffect::before_step(Body& body, double) {
  System& system = body.model->system();
  PairSums* device = blend_.pair_sums();
  if (device == nullptr || !device->cohesion(sums_)) sum_pairs(system.particles.x);
  system.external_forces += strength() * sums_;
}

bool SurfaceTensionEffect::join_resident_run(ResidentRun& run) const {
  if (!run.particles) return false;
  run.particles->cohesion = strength();
  return true;
}

void SurfaceTensionEffect::sum_pairs(const Positions& x) {
  const SphKernels kernels(blend_.support());
  const NeighborLists& lists = blend_.neighbors(x);
  const Eigen::VectorXd &volumes = blend_.volumes(), &beta = blend_.beta();
  sums_.resize(3, x.cols());
  lists.for_each_point([&](int rank, int i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    lists.for_each_neighbor(rank, [&](int o) {
      const Eigen::Vector3d apart = x.col(i) - x.col(o);
      sum +=
          cohesion_slope(kernels, beta[i], beta[o], volumes[i], volumes[o], apart.squaredNorm()) *
          apart;
    });
    sums_.col(i) = sum;
  });
}

double SurfaceTensionEffect::potential_energy(const Body& body) const {
  const Positions& x = body.particles().x;
  const SphKernels kernels(blend_.support());
  NeighborLists lists;
  lists.build(x, blend_.support());
  double sum = 0.0;
  for (int k = 0; k < lists.size(); ++k) {
    const int i = lists.order()[static_cast<std::size_t>(k)];
    lists.for_each_neighbor(k, [&](int o) {
      const double weight = std::min(blend_.beta()[i], blend_.beta()[o]);
      sum += weight * blend_.volumes()[i] * blend_.volumes()[o] *
             kernels.poly6((x.col(i) - x.col(o)).squaredNorm());
    });
  }
  return -0.5 * strength() * sum;
}

EffectRegistry::Entry surface_tension_entry() {
  return {"surface_tension",
          "liquid pulls itself together: drops become round",
          {number_parameter("tension", "N/m", "0.07", 0.0, 1e3, "energy per area of the surface")},
          {"viscoelastic"},
          [](const Parameters& given, const EffectSite& site) {
            auto* blend = site.body.model->find<BlendedParticles>();
            if (blend == nullptr) {
              throw InputError("effect 'surface_tension' needs a body of particles");
            }
            return std::make_unique<SurfaceTensionEffect>(*blend, given.number("tension"));
          }};
}

}  // namespace pliant
