#include "pliant/elements/solids/averaged_tetrahedra.h"

#include <fmt/format.h>

#include <cmath>

#include "pliant/elements/stencil_set.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr const char* kName = "averaged_tetrahedra";

}  // namespace

ParameterSpec strain_parameter() {
  return choice_parameter("strain", "tetrahedra", {"tetrahedra", kAveragedStrain},
                          "averaged: around edges and vertices; bends right on coarse meshes and "
                          "does not lock near Poisson's ratio 0.5, for more time");
}

std::vector<std::unique_ptr<ElementSet>> averaged_tetrahedra(const TetrahedralMesh& rest,
                                                             const LameParameters& lame,
                                                             int first_particle) {
  if (!(std::isfinite(lame.mu) && lame.mu > 0.0 && std::isfinite(lame.lambda) &&
        lame.lambda >= 0.0)) {
    throw InputError(fmt::format(
        "{}: the Lamé parameters are λ = {} Pa and μ = {} Pa, but must be finite, λ >= 0 and μ > 0",
        kName, lame.lambda, lame.mu));
  }
  const auto keep = [](GradientStencils stencils) {
    return std::make_shared<const GradientStencils>(std::move(stencils));
  };
  const auto tetrahedra = keep(tetrahedron_stencils(kName, rest, first_particle));
  std::vector<std::unique_ptr<ElementSet>> sets;
  sets.push_back(std::make_unique<StencilSet<ShearLaw>>(
      kName, StencilPlaces{keep(edge_stencils(kName, rest, first_particle)), tetrahedra}, lame.mu));
  if (lame.lambda > 0.0) {
    sets.push_back(std::make_unique<StencilSet<PressureLaw>>(
        kName, StencilPlaces{keep(vertex_means(*tetrahedra)), tetrahedra}, lame.lambda));
  }
  return sets;
}

}  // namespace pliant
