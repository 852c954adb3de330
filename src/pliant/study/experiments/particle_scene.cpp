#include "pliant/study/experiments/particle_scene.h"

#include "pliant/effects/registry.h"
#include "pliant/models/solver_registry.h"

namespace pliant {

BodyGeometry lattice_body(const Eigen::Vector3i& counts, double spacing) {
  BodyGeometry geometry;
  geometry.interior_points.resize(3, counts.prod());
  Eigen::Index i = 0;
  for (int z = 0; z < counts[2]; ++z) {
    for (int y = 0; y < counts[1]; ++y) {
      for (int x = 0; x < counts[0]; ++x, ++i) {
        geometry.interior_points.col(i) =
            spacing * (Eigen::Vector3d(x, y, z).array() + 0.5).matrix();
      }
    }
  }
  geometry.volume = spacing * spacing * spacing * counts.prod();
  return geometry;
}

ParticleScene::ParticleScene(const BodyGeometry& geometry,
                             const ViscoelasticModel::Material& material, double dt)
    : world_(dt) {
  world_.add_body("body", std::make_unique<ViscoelasticModel>(geometry, material));
}

void ParticleScene::add_effect(const std::string& name, const ParameterText& parameters) {
  world_.add_effect(body(), effect_registry(), name, parameters, name);
}

void ParticleScene::fix_below(int axis, double limit) {
  for (int i = 0; i < particles().size(); ++i) {
    if (particles().x(axis, i) < limit) particles().fix(i);
  }
}

void ParticleScene::start(const std::string& solver, const ParameterText& parameters) {
  world_.set_initial_state();
  world_.set_solver(body(), all_solvers(), solver, parameters, solver);
}

}  // namespace pliant
