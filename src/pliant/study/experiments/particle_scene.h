#pragma once

#include <string>

#include "pliant/core/world.h"
#include "pliant/models/viscoelastic/viscoelastic.h"

namespace pliant {

/// Particles on a lattice that fills a box from the origin on, half a spacing from its sides.
BodyGeometry lattice_body(const Eigen::Vector3i& counts, double spacing);

/// A world of one body of particles.
class ParticleScene {
 public:
  ParticleScene(const BodyGeometry& geometry, const ViscoelasticModel::Material& material,
                double dt);
  void add_effect(const std::string& name, const ParameterText& parameters = {});
  /// Fixes the particles with a coordinate below `limit` along `axis` [m].
  void fix_below(int axis, double limit);
  void start(const std::string& solver, const ParameterText& parameters);

  World& world() { return world_; }
  Body& body() { return world_.bodies().front(); }
  ViscoelasticModel& model() { return static_cast<ViscoelasticModel&>(*body().model); }
  Particles& particles() { return body().particles(); }

 private:
  World world_;
};

}  // namespace pliant
