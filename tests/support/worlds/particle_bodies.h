#pragma once

#include <memory>

#include "pliant/core/world.h"
#include "pliant/effects/registry.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/models/solver_registry.h"
#include "pliant/models/viscoelastic/interior_samples.h"
#include "pliant/models/viscoelastic/viscoelastic.h"
#include "pliant/study/experiments/particle_scene.h"

namespace pliant {

/// Particles as scenes spread them in a box about the origin.
inline BodyGeometry sampled_box(const Eigen::Vector3d& size, double spacing) {
  BodyGeometry geometry;
  InteriorSamples samples = sample_interior(Box(size).surface(), spacing);
  geometry.interior_points = std::move(samples.points);
  geometry.volume = samples.volume;
  return geometry;
}

inline ViscoelasticModel::Material liquid_material() {
  ViscoelasticModel::Material material;
  material.beta = 1.0;
  return material;
}

/// A world of one body of particles, which others may join, without effects.
class ParticleWorld {
 public:
  /// Without a body yet.
  explicit ParticleWorld(double dt) : world_(dt) {}
  ParticleWorld(const BodyGeometry& geometry, const ViscoelasticModel::Material& material,
                double dt)
      : world_(dt) {
    add(geometry, material);
  }
  void add(const BodyGeometry& geometry, const ViscoelasticModel::Material& material,
           const Eigen::Vector3d& place = Eigen::Vector3d::Zero(),
           const Eigen::Vector3d& velocity = Eigen::Vector3d::Zero()) {
    auto model = std::make_unique<ViscoelasticModel>(geometry, material);
    model->place(Eigen::Isometry3d(Eigen::Translation3d(place)));
    model->set_velocity(velocity);
    if (world_.bodies().empty()) {
      world_.add_body("body", std::move(model));
    } else {
      body().model->join(*model);
    }
  }
  void add_effect(const std::string& name, const ParameterText& parameters = {}) {
    world_.add_effect(body(), effect_registry(), name, parameters, name);
  }
  void add_box(const Eigen::Vector3d& size, const Eigen::Vector3d& place) {
    Obstacle obstacle;
    obstacle.name = "box";
    obstacle.shape = std::make_shared<Box>(size);
    obstacle.pose_start = obstacle.pose_end = Eigen::Isometry3d(Eigen::Translation3d(place));
    world_.add_obstacle(obstacle);
  }
  void start(const std::string& solver = "jacobi",
             const ParameterText& parameters = {{"iterations", "20"}, {"tolerance", "1e-6"}}) {
    world_.set_initial_state();
    world_.set_solver(body(), all_solvers(), solver, parameters, solver);
  }
  /// Steps until `time` [s]; the failure, if any.
  std::string run_until(double time) {
    while (world_.time() < time - 1e-9) {
      if (!world_.step()) return world_.failure();
    }
    return {};
  }

  World& world() { return world_; }
  Body& body() { return world_.bodies().front(); }
  ViscoelasticModel& model() { return static_cast<ViscoelasticModel&>(*body().model); }
  Particles& particles() { return body().particles(); }

 private:
  World world_;
};

/// Four walls and a floor about the box from the origin to `size`.
inline void add_basin(ParticleWorld& world, const Eigen::Vector3d& size) {
  const double thick = 0.1, height = 4.0 * size.z();
  const Eigen::Vector3d middle = 0.5 * size;
  world.add_box({size.x() + 2 * thick, size.y() + 2 * thick, thick},
                {middle.x(), middle.y(), -0.5 * thick});
  for (double side : {-1.0, 1.0}) {
    world.add_box({thick, size.y() + 2 * thick, height},
                  {middle.x() + side * (middle.x() + 0.5 * thick), middle.y(), 0.5 * height});
    world.add_box({size.x() + 2 * thick, thick, height},
                  {middle.x(), middle.y() + side * (middle.y() + 0.5 * thick), 0.5 * height});
  }
}

}  // namespace pliant
