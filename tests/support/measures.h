#pragma once

#include <algorithm>
#include <string>

#include "pliant/elements/cloth/spring_set.h"
#include "support/solvers/projective_model.h"
#include "support/worlds/worlds.h"

namespace pliant {

/// Strains of the stretch springs.
inline Eigen::VectorXd stretch_strains(const World& world) {
  const Body& body = world.bodies().front();
  const auto& system = projective_system(*body.model);
  const auto& springs = dynamic_cast<const SpringSet&>(*system.elements.front());
  return springs.strains(body.particles().x);
}

inline double largest_strain(const World& world) { return stretch_strains(world).maxCoeff(); }

/// [m/s]
inline double largest_speed(const World& world) {
  return world.bodies().front().particles().v.colwise().norm().maxCoeff();
}

/// Largest distance of a vertex from the origin [m].
inline double extent(const World& world) {
  return world.bodies().front().particles().x.colwise().norm().maxCoeff();
}

/// Height of the lowest vertex [m].
inline double lowest(const World& world) {
  return world.bodies().front().particles().x.row(2).minCoeff();
}

/// Elastic and kinetic energy of all bodies, and that of their height where gravity is 9.81 m/s²
/// [J].
inline double energy_under_gravity(const World& world) {
  double sum = 0.0;
  for (const Body& body : world.bodies()) {
    const System& system = body.model->system();
    const Particles& p = system.particles;
    sum += system.elastic_energy() + system.kinetic_energy() + 9.81 * p.x.row(2).dot(p.mass);
  }
  return sum;
}

/// Whether a warning of the last report holds `text`.
inline bool warns(const World& world, const std::string& text) {
  const auto& warnings = world.bodies().front().report.warnings;
  return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
    return warning.find(text) != std::string::npos;
  });
}

}  // namespace pliant
