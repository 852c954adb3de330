#include "pliant/effects/surface_tension.h"

#include <algorithm>

#include "pliant/core/body.h"
#include "pliant/core/neighbor_lists.h"
#include "pliant/core/parallel.h"
#include "pliant/math/error.h"
#include "pliant/math/sph_kernels.h"

namespace pliant {
namespace {
constexpr int kGrain = 256;
// Of the integral's surface energy particles half a support's distance apart have so much, since
// none are nearer to each other (measured: SurfaceTension.HasTheEnergyOfTheSurfaceItMakes).
constexpr double kDiscrete = 0.8;
std::size_t at(int k) { return static_cast<std::size_t>(k); }
}  // namespace

double SurfaceTensionEffect::strength() const {
  return 1024.0 / 63.0 / kDiscrete * tension_ / blend_.support();
}

void SurfaceTensionEffect::before_step(Body& body, double) {
  System& system = body.model->system();
  const Positions& x = system.particles.x;
  const SphKernels kernels(blend_.support());
  const NeighborLists& lists = blend_.neighbors(x);
  const std::vector<int>& order = lists.order();
  const Eigen::VectorXd &volumes = blend_.volumes(), &beta = blend_.beta();
  const double strength = this->strength();
  parallel_for(0, lists.size(), kGrain, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const int i = order[at(k)];
      Eigen::Vector3d force = Eigen::Vector3d::Zero();
      for (const int* j = lists.begin(k); j != lists.end(k); ++j) {
        const int o = order[at(*j)];
        const Eigen::Vector3d apart = x.col(i) - x.col(o);
        const double weight = std::min(beta[i], beta[o]);
        force +=
            weight * (volumes[i] * volumes[o]) * kernels.poly6_slope(apart.squaredNorm()) * apart;
      }
      system.external_forces.col(i) += strength * force;
    }
  });
}

double SurfaceTensionEffect::potential_energy(const Body& body) const {
  const Positions& x = body.particles().x;
  const SphKernels kernels(blend_.support());
  NeighborLists lists;
  lists.build(x, blend_.support());
  const std::vector<int>& order = lists.order();
  double sum = 0.0;
  for (int k = 0; k < lists.size(); ++k) {
    const int i = order[at(k)];
    for (const int* j = lists.begin(k); j != lists.end(k); ++j) {
      const int o = order[at(*j)];
      const double weight = std::min(blend_.beta()[i], blend_.beta()[o]);
      sum += weight * blend_.volumes()[i] * blend_.volumes()[o] *
             kernels.poly6((x.col(i) - x.col(o)).squaredNorm());
    }
  }
  return -0.5 * strength() * sum;
}

EffectRegistry::Entry surface_tension_entry() {
  return {"surface_tension",
          "liquid pulls itself together: drops become round",
          {number_parameter("tension", "N/m", "0.07", 0.0, 1e3, "energy per area of the surface")},
          {"viscoelastic"},
          [](const Parameters& given, const EffectSite& site) {
            auto* blend = dynamic_cast<BlendedParticles*>(site.body.model.get());
            if (blend == nullptr) {
              throw InputError("effect 'surface_tension' needs a body of particles");
            }
            return std::make_unique<SurfaceTensionEffect>(*blend, given.number("tension"));
          }};
}

}  // namespace pliant
