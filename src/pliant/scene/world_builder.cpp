#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "pliant/core/parallel/parallel.h"
#include "pliant/effects/attachment.h"
#include "pliant/effects/registry.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/repair/collider_file.h"
#include "pliant/math/error.h"
#include "pliant/models/registry.h"
#include "pliant/models/solver_registry.h"
#include "pliant/models/viscoelastic/heat_parameters.h"
#include "pliant/scene/body_groups.h"
#include "pliant/scene/extensions.h"
#include "pliant/scene/file_access.h"
#include "pliant/scene/reading/fixed_vertices.h"
#include "pliant/scene/reading/geometry_kinds.h"
#include "pliant/scene/reading/solver_choice.h"
#include "pliant/scene/robot/scene_robots.h"
#include "pliant/scene/scene.h"
#include "pliant/scene/start_in_obstacles.h"
#include "pliant/scene/yaml/place_error.h"
#include "pliant/solvers/time/time_integrations.h"

namespace pliant {
namespace {

std::shared_ptr<const Shape> make_shape(const ObstacleSpec& spec, std::vector<std::string>& notes) {
  if (spec.shape == "plane") return std::make_shared<Plane>();
  if (spec.shape == "sphere") return std::make_shared<Sphere>(spec.radius);
  if (spec.shape == "box") return std::make_shared<Box>(spec.size);
  if (spec.shape == "capsule") return std::make_shared<Capsule>(spec.radius, spec.length);
  if (spec.shape == "cylinder") return std::make_shared<Cylinder>(spec.radius, spec.length);
  const ColliderOptions options = {spec.collider, spec.voxel_size, spec.thickness};
  const MeshCollider made =
      load_mesh_collider(spec.mesh_path, Eigen::Vector3d::Constant(spec.scale), options);
  notes.push_back(fmt::format("obstacle '{}': collider {}", spec.name, made.note));
  return made.shape;
}

Obstacle make_obstacle(const ObstacleSpec& spec, std::vector<std::string>& notes) {
  Obstacle obstacle;
  obstacle.name = spec.name;
  obstacle.shape = with_place(spec.place.text() + ": obstacle '" + spec.name + "'",
                              [&] { return make_shape(spec, notes); });
  obstacle.pose_start = obstacle.pose_end = spec.world_from_shape;
  obstacle.friction = spec.friction;
  obstacle.temperature = spec.temperature;
  obstacle.liquid = spec.liquid;
  obstacle.color = spec.color.value_or(obstacle.color);
  return obstacle;
}

MadeGeometry make_geometry(const GeometrySpec& spec, const std::string& model) {
  if (spec.grid) return BodyGeometry{make_grid(*spec.grid), spec.grid};
  MadeGeometry geometry =
      find_geometry_kind(spec.kind, model).make(spec.path, spec.size, spec.options);
  const Eigen::Index vertices =
      geometry.tetrahedra ? geometry.tetrahedra->vertices.cols() : geometry.mesh.vertices.cols();
  if (vertices > kMaxVertices) {
    throw InputError(
        fmt::format("it has {} vertices, but at most {} are allowed", vertices, kMaxVertices));
  }
  return geometry;
}

void place_body(const BodySpec& spec, Model& model) {
  if (!spec.fixed.empty() && !model.why_not_fix().empty()) {
    throw InputError(fmt::format("{}: fixed: body '{}': {}", spec.fixed.front().place.text(),
                                 spec.name, model.why_not_fix()));
  }
  model.place(spec.world_from_body);
  fix_vertices(spec, model.particles());
  model.set_velocity(spec.velocity);
}

constexpr const char* kFileMaterial = "of its file's material";  // begins a note

/// What the scene says of the material, and what the mesh's file says of the rest.
ParameterText material_of(const BodySpec& spec, const MadeGeometry& geometry,
                          std::vector<std::string>& notes) {
  ParameterText text = spec.model.parameters;
  if (!geometry.material) return text;
  const auto& [name, density, young, poisson] = *geometry.material;
  std::string taken;
  const auto take = [&](const char* key, double value) {
    if (!text.emplace(key, fmt::format("{}", value)).second) return;
    taken += fmt::format("{}{} {}", taken.empty() ? "" : ", ", key, value);
  };
  take("young", young);
  take("poisson", poisson);
  take("density", density);
  if (!taken.empty()) {
    notes.push_back(fmt::format("body '{}': {} '{}': {}", spec.name, kFileMaterial, name, taken));
  }
  return text;
}

std::unique_ptr<Model> make_model(const BodySpec& spec, std::vector<std::string>& notes) {
  const std::string where = spec.geometry.place.text() + ": geometry of body '" + spec.name + "'";
  const MadeGeometry geometry =
      with_place(where, [&] { return make_geometry(spec.geometry, spec.model.name); });
  if (!geometry.note.empty()) {
    notes.push_back(fmt::format("body '{}': its mesh was mended: {}", spec.name, geometry.note));
  }
  std::unique_ptr<Model> model = with_place(spec.model.where, [&] {
    const auto& entry = model_registry().find(spec.model.name);
    return entry.make(
        parse_parameters(entry.parameters, material_of(spec, geometry, notes), spec.model.where),
        geometry);
  });
  if (spec.color) model->color = *spec.color;
  place_body(spec, *model);
  return model;
}

const NamedParameters* find_effect(const SceneSpec& scene, const std::string& name) {
  for (const NamedParameters& effect : scene.effects) {
    if (effect.name == name) return &effect;
  }
  return nullptr;
}

bool has_effect(const SceneSpec& scene, const std::string& name) {
  return find_effect(scene, name) != nullptr;
}

template <class AnyRegistry>
bool suits(const AnyRegistry& registry, const std::string& name, const Body& body) {
  const auto& models = registry.find(name).models;
  return std::find(models.begin(), models.end(), body.model->name()) != models.end();
}

/// `first`: of the body's particles among those of `body`, which others may have joined.
void add_attachments(const BodySpec& spec, int first, int count, Body& body, const World& world) {
  for (const AttachmentSpec& attachment : spec.attachments) {
    const std::string where = fmt::format("{}: attachment '{}' of body '{}'",
                                          attachment.place.text(), attachment.name, spec.name);
    with_place(where, [&] {
      AttachmentRequest request;
      request.name = attachment.name;
      request.region = make_region(attachment.region, spec);
      request.first = first;
      request.count = count;
      request.obstacle = find_holder(attachment.to, world.obstacles());
      request.stiffness = attachment.stiffness;
      request.from = attachment.from;
      request.until = attachment.until.value_or(request.until);
      attachments_of(body, world.obstacles()).add(request);
    });
  }
}

/// What the scene says of each of a world's bodies: of one that others joined, of all of them.
using BodySpecs = std::map<const Body*, std::vector<const BodySpec*>>;

/// Bodies that touch each other have to be moved by one solver: those that can be are joined.
BodySpecs add_bodies(const SceneSpec& scene, World& world, std::vector<std::string>& notes) {
  const NamedParameters* self_contact = find_effect(scene, "self_contact");
  struct Part {
    Body* body;
    int first, count;
  };
  std::vector<Part> parts;
  long long points = 0;
  for (const BodySpec& spec : scene.bodies) {
    std::unique_ptr<Model> model = make_model(spec, notes);
    const int count = model->particles().size();
    points += count;
    // Of most kinds the reader has refused too many before; how many a file holds, or a spacing
    // makes, is known only now.
    if (points > kMaxVertices) {
      throw InputError(fmt::format(
          "{}: geometry of body '{}': with it the bodies have {} vertices together, but at most {} "
          "are allowed",
          spec.geometry.place.text(), spec.name, points, kMaxVertices));
    }
    const bool touches = self_contact != nullptr && self_contact->acts_on(spec.name);
    const auto joined = std::find_if(world.bodies().begin(), world.bodies().end(), [&](Body& body) {
      const auto first = std::find_if(parts.begin(), parts.end(),
                                      [&](const Part& part) { return part.body == &body; });
      const std::string& name = scene.bodies[static_cast<std::size_t>(first - parts.begin())].name;
      const bool joins = model->always_joins() || (touches && self_contact->acts_on(name));
      return joins && body.model->join(*model);
    });
    if (joined == world.bodies().end()) {
      parts.push_back({&world.add_body(spec.name, std::move(model)), 0, count});
    } else {
      joined->name += "+" + spec.name;
      parts.push_back({&*joined, joined->particles().size() - count, count});
    }
  }
  BodySpecs specs;
  for (std::size_t b = 0; b < parts.size(); ++b) {
    specs[parts[b].body].push_back(&scene.bodies[b]);
    add_attachments(scene.bodies[b], parts[b].first, parts[b].count, *parts[b].body, world);
  }
  return specs;
}

/// Whether an effect names a body, or bodies that are moved as one, or none at all. Throws
/// InputError where it names some of those that are moved as one.
bool acts_on(const NamedParameters& effect, const std::vector<const BodySpec*>& specs) {
  const auto count = std::count_if(
      specs.begin(), specs.end(), [&](const BodySpec* spec) { return effect.acts_on(spec->name); });
  if (count == 0 || count == static_cast<std::ptrdiff_t>(specs.size())) return count > 0;
  const auto other = std::find_if(specs.begin(), specs.end(), [&](const BodySpec* spec) {
    return !effect.acts_on(spec->name);
  });
  throw InputError(
      fmt::format("{}.bodies leaves out '{}', which is moved as one with others that it names: "
                  "name all of them or none",
                  effect.where, (*other)->name));
}

/// An effect acts on the bodies that it is made for, or on those of them that it names; one that is
/// made for none of them is refused.
void add_effects(const SceneSpec& scene, const std::vector<const BodySpec*>& specs, Body& body,
                 World& world) {
  for (const NamedParameters& effect : scene.effects) {
    if (!acts_on(effect, specs)) continue;
    const bool suits_another = std::any_of(
        world.bodies().begin(), world.bodies().end(),
        [&](const Body& other) { return suits(effect_registry(), effect.name, other); });
    if (suits_another && !suits(effect_registry(), effect.name, body)) continue;
    with_place(effect.where, [&] {
      world.add_effect(body, effect_registry(), effect.name, effect.parameters, effect.where);
    });
  }
}

std::vector<std::string> models_of(const Group& group) {
  std::vector<std::string> models;
  for (const Body* body : group.bodies()) models.emplace_back(body->model->name());
  return models;
}

void set_backend(const std::string& backend, const std::string& body, NamedParameters& solver) {
  const std::vector<ParameterSpec>& known = all_solvers().find(solver.name).parameters;
  if (std::any_of(known.begin(), known.end(), [](auto& spec) { return spec.name == "backend"; })) {
    solver.parameters["backend"] = backend;
  } else if (backend == "cuda") {
    throw InputError(fmt::format(
        "backend 'cuda': solver '{}' of body '{}' runs on the CPU only; give another solver",
        solver.name, body));
  }
}

void set_solver(const SceneSpec& scene, const std::vector<const BodySpec*>& specs, Body& body,
                World& world) {
  const Group& group = *body.group;
  NamedParameters solver =
      choose_solver(scene, specs, models_of(group), group.system().particles.size());
  if (scene.backend) set_backend(*scene.backend, body.name, solver);
  with_place(solver.where, [&] {
    world.set_solver({&body}, all_solvers(), solver.name, solver.parameters, solver.where);
  });
}

/// What the bodies of a group name of their own: all of them the same; or null.
const NamedParameters* own_time_integration(const BodySpecs& specs, const Group& group) {
  const BodySpec* first = nullptr;
  for (const Body* body : group.bodies()) {
    for (const BodySpec* spec : specs.at(body)) {
      if (!spec->time_integration) continue;
      if (first == nullptr) {
        first = spec;
      } else if (first->time_integration->name != spec->time_integration->name) {
        throw InputError(fmt::format(
            "{}: bodies '{}' and '{}' may touch and are moved together: give both the same",
            spec->time_integration->where, first->name, spec->name));
      }
    }
  }
  return first == nullptr ? nullptr : &*first->time_integration;
}

/// Whether all of them can have it: a scene's is for those bodies alone.
bool suits(const std::string& integration, const Group& group) {
  const std::vector<std::string>& models = time_integrations().find(integration).models;
  return std::all_of(group.bodies().begin(), group.bodies().end(), [&](const Body* body) {
    return std::find(models.begin(), models.end(), body->model->name()) != models.end();
  });
}

/// Of the group of which `body` is the first.
void set_time_integration(const SceneSpec& scene, const BodySpecs& specs, Body& body,
                          World& world) {
  const NamedParameters* chosen = own_time_integration(specs, *body.group);
  if (chosen == nullptr && scene.time_integration &&
      suits(scene.time_integration->name, *body.group)) {
    chosen = &*scene.time_integration;
  }
  if (chosen == nullptr) return;
  with_place(chosen->where,
             [&] { world.set_time_integration(body, time_integrations(), chosen->name); });
}

void set_time_integrations(const SceneSpec& scene, const BodySpecs& specs, World& world) {
  for (Body& body : world.bodies()) {
    if (&body.group->first() == &body) set_time_integration(scene, specs, body, world);
  }
  if (!scene.time_integration) return;
  const std::string& name = scene.time_integration->name;
  const bool is_of_use = std::any_of(world.bodies().begin(), world.bodies().end(),
                                     [&](const Body& body) { return suits(name, *body.group); });
  if (is_of_use) return;
  const auto& models = time_integrations().find(name).models;
  for (const Body& body : world.bodies()) {
    if (std::find(models.begin(), models.end(), body.model->name()) != models.end()) continue;
    throw InputError(fmt::format(
        "{}: '{}' is for no body of the scene: '{}' is of the model '{}', which has a time "
        "integration of its own, and bodies that may touch it are moved with it",
        scene.time_integration->where, name, body.name, body.model->name()));
  }
}

/// Bodies whose time integration is another than the scene's.
void warn_of_time_integration(const SceneSpec& scene, const World& world,
                              std::vector<std::string>& warnings) {
  if (!scene.time_integration) return;
  const std::string& name = scene.time_integration->name;
  for (const Body& body : world.bodies()) {
    if (suits(name, *body.group)) continue;
    const auto& models = time_integrations().find(name).models;
    const bool is_own = std::find(models.begin(), models.end(), body.model->name()) == models.end();
    warnings.push_back(fmt::format(
        "time_integration '{}' is not that of body '{}', {}", name, body.name,
        is_own ? fmt::format("since the model '{}' has its own", body.model->name())
               : "since it is moved together with bodies that it may touch and whose models have "
                 "their own"));
  }
}

/// A parameter of the body's material that only the effect `heat` looks at; "" without.
std::string heat_key(const BodySpec& body) {
  if (body.model.name != "viscoelastic") return "";
  for (const ParameterSpec& spec : heat_parameters()) {
    if (body.model.parameters.count(spec.name) > 0) return spec.name;
  }
  return "";
}

/// What a scene that names no solver does not say of a large body.
void warn_of_large(const SceneSpec& scene, const Body& body, std::vector<std::string>& warnings) {
  const bool has_own = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                   [](const BodySpec& spec) { return spec.solver.has_value(); });
  const int vertices = body.group->system().particles.size();
  if (scene.names_solver || has_own || vertices <= kMostForDefault) return;
  const std::vector<std::string> models = models_of(*body.group);
  const bool are_alike = std::count(models.begin(), models.end(), models.front()) ==
                         static_cast<std::ptrdiff_t>(models.size());
  const DefaultSolver usual =
      default_solver_among(std::string(body.model->name()), models, are_alike);
  const std::string name(body.solver->name());
  if (name != usual.name) {
    warnings.push_back(fmt::format(
        "body '{}' has more than {} vertices: '{}' moves it, not the default '{}', whose matrix "
        "would take too much memory; name a 'solver' to choose",
        body.name, kMostForDefault, name, usual.name));
  } else if (usual.parameters.count("error") > 0) {
    warnings.push_back(
        fmt::format("body '{}' has more than {} vertices: '{}' takes the same number of "
                    "iterations in every step, whatever the error, which takes long to estimate "
                    "there; name a 'solver' to choose",
                    body.name, kMostForDefault, name));
  }
}

std::vector<std::string> find_warnings(const LoadedScene& scene) {
  std::vector<std::string> warnings;
  if (!scene.world->obstacles().empty() && !has_effect(scene.spec, "contact")) {
    warnings.emplace_back(
        "the scene has obstacles, but not the effect 'contact': bodies pass "
        "through them");
  }
  if (!has_effect(scene.spec, "heat")) {
    for (const BodySpec& body : scene.spec.bodies) {
      const std::string key = heat_key(body);
      if (key.empty()) continue;
      warnings.push_back("body '" + body.name + "' has a " + key +
                         ", but the scene has not the effect 'heat': it does nothing");
    }
  }
  for (const Body& body : scene.world->bodies()) warn_of_large(scene.spec, body, warnings);
  warn_of_time_integration(scene.spec, *scene.world, warnings);
  const auto& bodies = scene.world->bodies();
  const bool are_grouped = std::any_of(bodies.begin(), bodies.end(), [](const Body& body) {
    return body.group->joint() != nullptr;
  });
  if (has_effect(scene.spec, "body_contact") && !are_grouped) {
    warnings.emplace_back(
        "the scene has the effect 'body_contact', but not two bodies that it acts on: it does "
        "nothing");
  }
  for (std::string& warning : NearBodies().find(scene.world->bodies(), scene.world->body_pairs())) {
    warnings.push_back(std::move(warning));
  }
  for (std::string& warning : find_starts_in_obstacles(*scene.world)) {
    warnings.push_back(std::move(warning));
  }
  return warnings;
}

std::unique_ptr<World> build(const SceneSpec& spec, const SceneOverrides& overrides,
                             std::vector<SceneRobot>& robots, std::vector<std::string>& notes) {
  auto world = std::make_unique<World>(spec.time_step);
  world->finite_check() = spec.limits;
  for (const ObstacleSpec& obstacle : spec.obstacles) {
    world->add_obstacle(make_obstacle(obstacle, notes));
  }
  robots = add_robots(spec, overrides, *world);
  for (const SceneRobot& robot : robots) {
    for (const std::string& note : robot.robot->collider_notes()) {
      notes.push_back("robot link " + note);
    }
  }
  const BodySpecs specs = add_bodies(spec, *world, notes);
  group_bodies(spec, *world);
  for (Body& body : world->bodies()) add_effects(spec, specs.at(&body), body, *world);
  world->set_initial_state();
  for (Body& body : world->bodies()) {
    set_solver(spec, specs.at(&body), body, *world);
  }
  set_time_integrations(spec, specs, *world);
  return world;
}

}  // namespace

void apply_overrides(const SceneOverrides& overrides, SceneSpec& spec) {
  NamedParameters solver = spec.solver;
  // One that is named has its own defaults, not those of a scene that names none.
  if (overrides.solver && (*overrides.solver != solver.name || !spec.names_solver)) {
    solver = {*overrides.solver, {}, "solver '" + *overrides.solver + "'"};
  } else if (!spec.names_solver && !overrides.solver_parameters.empty()) {
    // Nor do its parameters stand beside those that are given: an error that it asks for would
    // change given iterations.
    solver.parameters.clear();
  }
  for (const auto& [name, value] : overrides.solver_parameters) {
    solver.parameters[name] = value;
    solver.where = "solver '" + solver.name + "'";
  }
  parse_parameters(all_solvers().find(solver.name).parameters, solver.parameters, solver.where);
  if (overrides.time_step && !(*overrides.time_step > 0.0 && *overrides.time_step <= 1.0)) {
    throw InputError(
        fmt::format("time step is {} s, but must be > 0 and <= 1 s", *overrides.time_step));
  }
  if (overrides.solver) {
    for (BodySpec& body : spec.bodies) body.solver.reset();
  }
  spec.names_solver = spec.names_solver || overrides.solver || !overrides.solver_parameters.empty();
  spec.solver = std::move(solver);
  if (overrides.time_integration) {
    time_integrations().find(*overrides.time_integration);
    spec.time_integration = {*overrides.time_integration, {}, "time_integration"};
    for (BodySpec& body : spec.bodies) body.time_integration.reset();
  }
  spec.time_step = overrides.time_step.value_or(spec.time_step);
  if (overrides.threads) spec.threads = overrides.threads;
  if (overrides.backend) spec.backend = overrides.backend;
}

std::unique_ptr<World> build_world(const SceneSpec& spec) {
  std::vector<SceneRobot> robots;
  std::vector<std::string> notes;
  return build(spec, {}, robots, notes);
}

namespace {

/// A mesh that is used as it is ends its note with that word.
bool is_of_mended(const std::string& note) {
  if (note.find(kFileMaterial) != std::string::npos) return false;
  const std::string exact = " " + collider_name(ColliderKind::kExact);
  return note.size() < exact.size() ||
         note.compare(note.size() - exact.size(), exact.size(), exact) != 0;
}

}  // namespace

LoadedScene load_scene(const std::string& path, const SceneOverrides& overrides) {
  load_extensions_of_environment();
  LoadedScene scene;
  const SceneFolder folder(path);
  const std::string* text = overrides.text ? &*overrides.text : nullptr;
  scene.spec = read_scene(path, overrides.package_resolver, overrides.values, text);
  apply_overrides(overrides, scene.spec);
  const std::optional<int>& count =
      scene.spec.threads ? scene.spec.threads : overrides.usual_threads;
  if (count && !overrides.keeps_threads) set_threads(*count);
  scene.world = build(scene.spec, overrides, scene.robots, scene.notes);
  scene.warnings = find_warnings(scene);
  for (std::string& warning : robot_warnings(scene, overrides)) {
    scene.warnings.push_back(std::move(warning));
  }
  scene.mended_meshes =
      static_cast<int>(std::count_if(scene.notes.begin(), scene.notes.end(), is_of_mended));
  return scene;
}

}  // namespace pliant
