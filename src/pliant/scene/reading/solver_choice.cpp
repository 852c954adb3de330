#include "pliant/scene/reading/solver_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/scene/yaml/place_error.h"

namespace pliant {
namespace {

bool works_for(const std::string& solver, const BodySpec& body) {
  const auto& models = all_solvers().find(solver).models;
  return std::find(models.begin(), models.end(), body.model.name) != models.end();
}

/// The one that the bodies name, or null.
const NamedParameters* own_solver(const std::vector<const BodySpec*>& bodies) {
  const BodySpec* first = nullptr;
  for (const BodySpec* body : bodies) {
    if (!body->solver) continue;
    if (first == nullptr) {
      first = body;
    } else if (body->solver->name != first->solver->name ||
               body->solver->parameters != first->solver->parameters) {
      throw InputError(fmt::format("{}: bodies '{}' and '{}' are moved as one: give both the same",
                                   body->solver->where, first->name, body->name));
    }
  }
  return first == nullptr ? nullptr : &*first->solver;
}

/// The scene's works for none of its bodies: the error of the first of them.
void check_scene_solver(const SceneSpec& scene) {
  const bool is_of_use = std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](auto& body) {
    return works_for(scene.solver.name, body);
  });
  if (is_of_use) return;
  with_place(scene.solver.where,
             [&] { all_solvers().find_for(scene.solver.name, scene.bodies.front().model.name); });
}

/// Whether one solver may move all bodies that touch: none names another, and nothing is in the
/// scene with which newton converges slowly.
bool may_be_moved_as_one(const SceneSpec& scene) {
  const auto names_solver = [](const BodySpec& body) { return body.solver.has_value(); };
  const auto is_air = [](const NamedParameters& effect) { return effect.name == "air"; };
  return !scene.names_solver &&
         std::none_of(scene.bodies.begin(), scene.bodies.end(), names_solver) &&
         std::none_of(scene.effects.begin(), scene.effects.end(), is_air);
}

// Vertices of a held cloth that obstacles may stop, for which newton is chosen: beyond, a stiff one
// that lies on much of an obstacle takes several times the time of sweeps.
constexpr int kMostHeld = 3000;

bool has_effect(const SceneSpec& scene, const std::vector<std::string_view>& names) {
  return std::any_of(scene.effects.begin(), scene.effects.end(), [&](const NamedParameters& own) {
    return std::find(names.begin(), names.end(), own.name) != names.end();
  });
}

/// Whether something holds it when the scene begins.
bool is_held(const BodySpec& body) {
  const auto from_start = [](const AttachmentSpec& attachment) { return attachment.from <= 0.0; };
  return !body.fixed.empty() ||
         std::any_of(body.attachments.begin(), body.attachments.end(), from_start);
}

/// What moves a cloth better than sweeps, or null: newton one that hangs, in a part of the time and
/// with a part of the error; one that lies on something takes it up to ten times the time.
const DefaultSolver* solver_of_hanging(const SceneSpec& scene,
                                       const std::vector<const BodySpec*>& bodies, int vertices) {
  if (has_effect(scene, {"air", "body_contact", "strain_limit"})) return nullptr;
  if (!has_effect(scene, {"contact", "self_contact"})) return &default_newton();
  // Of water between cloth and obstacles newton finds no multipliers.
  const bool hangs =
      vertices <= kMostHeld && !has_effect(scene, {"wetness"}) &&
      std::all_of(bodies.begin(), bodies.end(), [](auto* body) { return is_held(*body); });
  return hangs ? &default_newton_of_held() : nullptr;
}

}  // namespace

NamedParameters choose_solver(const SceneSpec& scene, const std::vector<const BodySpec*>& body,
                              const std::vector<std::string>& models, int vertices) {
  if (const NamedParameters* own = own_solver(body)) return *own;
  if (scene.names_solver) {
    check_scene_solver(scene);
    if (works_for(scene.solver.name, *body.front())) return scene.solver;
  }
  const bool is_large = vertices > kMostForDefault;
  const bool are_alike = std::count(models.begin(), models.end(), models.front()) ==
                         static_cast<std::ptrdiff_t>(models.size());
  // newton has no form on a GPU.
  const bool on_cpu = !scene.backend || *scene.backend == "cpu";
  const bool as_one = !is_large && may_be_moved_as_one(scene) && (on_cpu || !are_alike);
  DefaultSolver chosen = default_solver_among(body.front()->model.name, models, as_one);
  const bool is_cloth = models == std::vector<std::string>{"cloth"};
  if (is_cloth && !is_large && scene.backend != "cuda") {
    const DefaultSolver* of_hanging = solver_of_hanging(scene, body, vertices);
    if (of_hanging != nullptr) chosen = *of_hanging;
  }
  // Solvers that take turns have no other form for large bodies.
  if (is_large && are_alike) chosen = default_solver_of_large(chosen);
  if (scene.backend && *scene.backend != "cpu") chosen = default_solver_on_gpu(chosen);
  return {chosen.name, chosen.parameters, scene.path};
}

}  // namespace pliant
