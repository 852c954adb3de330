#pragma once

namespace pliant {

/// What a body is made of, as it behaves at small strains.
struct ElasticMaterial {
  double young = 1e5;       ///< Young's modulus E > 0 [Pa]
  double poisson = 0.3;     ///< Poisson's ratio ν in [0, 0.5)
  double density = 1000.0;  ///< > 0 [kg/m³]
};

/// λ and μ of linear elasticity.
struct LameParameters {
  double lambda = 0.0;  ///< [Pa]
  double mu = 0.0;      ///< [Pa]
};

/// Of TetrahedronSet: μ = E / (2 (1 + ν)) and λ = E ν / ((1 + ν) (1 - 2 ν)), for ν in [0, 0.5).
/// Throws InputError, naming the field, for a value out of its range.
LameParameters lame_parameters(const ElasticMaterial& material);

/// Stiffnesses of the projective energies that together are such a material.
struct TetrahedronStiffness {
  double corotated = 0.0;  ///< s of TetrahedronSet [Pa]
  double volume = 0.0;     ///< κ of VolumeSet [Pa]; 0 (no such set) for Poisson's ratio 0
};

/// s = μ = E / (2 (1 + ν)) and κ = 3 λ = 3 E ν / ((1 + ν) (1 - 2 ν)). Both energies only pull
/// towards a rotation, so that λ < 0, Poisson's ratios below 0, cannot be made of them. Throws
/// InputError, naming the field, for a value out of its range.
TetrahedronStiffness tetrahedron_stiffness(const ElasticMaterial& material);

}  // namespace pliant
