#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/worlds/worlds.h"

namespace pliant {

/// What a test says about a scene with one body of the model `patch`.
struct PatchScene {
  std::string kind = "sphere";
  ParameterText size = {{"radius", "0.05"}};
  ParameterText options = {{"tetrahedra", "600"}};
  ParameterText material = {{"young", "2e4"}, {"poisson", "0.3"}, {"density", "500"}};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< world from body
  std::vector<Obstacle> obstacles;
  std::vector<std::pair<std::string, ParameterText>> effects;  ///< in the registry's order
  std::string solver = "newton";
  ParameterText solver_parameters;
  double time_step = 0.01;  ///< [s]
};

BodyGeometry make_patch_geometry(const PatchScene& scene);

std::unique_ptr<Model> make_patch_model(const PatchScene& scene);

std::unique_ptr<World> make_world(const PatchScene& scene);

/// A soft block that falls on a plane and is pressed by its weight.
PatchScene falling_block(const std::string& solver, const ParameterText& parameters);

/// A ball that falls on a plane with friction: it is about to roll, so that errors grow.
PatchScene falling_ball(const std::string& solver, const ParameterText& parameters);

}  // namespace pliant
