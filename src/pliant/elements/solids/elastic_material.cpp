#include "pliant/elements/solids/elastic_material.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "pliant/math/error.h"

namespace pliant {
namespace {

void check_positive(const char* name, double value, const char* unit) {
  if (std::isfinite(value) && value > 0.0) return;
  throw InputError(fmt::format("{} is {} {}, but must be positive and finite", name, value, unit));
}

}  // namespace

LameParameters lame_parameters(const ElasticMaterial& material) {
  check_positive("Young's modulus", material.young, "Pa");
  check_positive("density", material.density, "kg/m^3");
  const double nu = material.poisson;
  if (nu < 0.0) {
    throw InputError(fmt::format(
        "Poisson's ratio is {}, but must be in [0, 0.5): the energies of tetrahedra and of their "
        "volume cannot make a material that grows thicker when stretched; take 0",
        nu));
  }
  if (!(nu < 0.5)) {
    throw InputError(fmt::format(
        "Poisson's ratio is {}, but must be in [0, 0.5): at 0.5 the volume's stiffness is "
        "infinite; take 0.45, or 0.49 on a fine mesh",
        nu));
  }
  const double mu = material.young / (2.0 * (1.0 + nu));
  return {2.0 * mu * nu / (1.0 - 2.0 * nu), mu};
}

TetrahedronStiffness tetrahedron_stiffness(const ElasticMaterial& material) {
  const LameParameters lame = lame_parameters(material);
  return {lame.mu, 3.0 * lame.lambda};
}

}  // namespace pliant
