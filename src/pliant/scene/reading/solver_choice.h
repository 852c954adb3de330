#pragma once

#include <string>
#include <vector>

#include "pliant/scene/scene_spec.h"

namespace pliant {

/// What moves a body: the solver that it names itself, else the scene's where it works for its
/// model, else the default among `models`, those of all bodies that it may touch, of so many
/// vertices together. `body` has more than one spec where others joined it. Throws InputError where
/// these name different ones, or where the scene's works for none of its bodies.
NamedParameters choose_solver(const SceneSpec& scene, const std::vector<const BodySpec*>& body,
                              const std::vector<std::string>& models, int vertices);

}  // namespace pliant
