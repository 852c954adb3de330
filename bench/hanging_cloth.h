#pragma once

#include <memory>
#include <string>

#include "pliant/core/world.h"
#include "pliant/effects/registry.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/models/cloth/cloth.h"
#include "pliant/solvers/registry.h"

namespace pliant::bench {

struct HangingCloth {
  int side = 50;               // vertices along each side
  double size = 1.0;           // [m]
  double areal_density = 0.2;  // [kg/m²]
  double stretch = 5000.0;     // [N/m]
  double shear = 500.0;        // [N/m]
  int diagonals = 1;
  double time_step = 0.005;  // [s]
  std::string solver = "xpbd";
  ParameterText solver_parameters = {{"iterations", "10"}};
};

/// A square cloth of that kind with gravity, nothing held and no solver yet.
inline std::unique_ptr<World> make_cloth(const HangingCloth& options) {
  auto world = std::make_unique<World>(options.time_step);
  BodyGeometry geometry;
  geometry.grid = GridOptions{options.size, options.size, options.side, options.side};
  geometry.mesh = make_grid(*geometry.grid);
  ClothModel::Material material;
  material.areal_density = options.areal_density;
  material.stretch_warp = material.stretch_weft = options.stretch;
  material.shear = options.shear;
  material.bending_warp = material.bending_weft = 0.0;
  material.diagonals = options.diagonals;
  Body& body = world->add_body("cloth", std::make_unique<ClothModel>(geometry, material));
  world->add_effect(body, effect_registry(), "gravity", {}, "bench");
  return world;
}

inline void start(World& world, const HangingCloth& options) {
  world.set_initial_state();
  world.set_solver(world.bodies().front(), solver_registry(), options.solver,
                   options.solver_parameters, "bench");
}

/// A square cloth held at two corners, with gravity and nothing else.
inline std::unique_ptr<World> make_hanging_cloth(const HangingCloth& options) {
  auto world = make_cloth(options);
  world->bodies().front().particles().fix(0);
  world->bodies().front().particles().fix(options.side - 1);
  start(*world, options);
  return world;
}

struct Strain {
  double mean = 0.0;
  double max = 0.0;
};

/// Of the structural links, in share of the rest length; compression counts by its size.
inline Strain stretch_strain(const World& world) {
  const Body& body = world.bodies().front();
  const auto& system = static_cast<const ProjectiveSystem&>(body.model->system());
  for (const auto& set : system.elements) {
    const auto* springs = dynamic_cast<const SpringSet*>(set.get());
    if (springs == nullptr || springs->name() != "stretch") continue;
    const Eigen::VectorXd strains = springs->strains(body.particles().x).cwiseAbs();
    return {strains.mean(), strains.maxCoeff()};
  }
  return {};
}

}  // namespace pliant::bench
