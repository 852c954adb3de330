#include "pliant/study/generated/generated_scene.h"

#include <fmt/format.h>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/io/tetrahedral_file.h"
#include "pliant/models/solver_registry.h"
#include "pliant/scene/reading/geometry_kinds.h"
#include "pliant/study/generated/generated_effects.h"
#include "pliant/study/generated/generated_random.h"

namespace pliant {
namespace {

constexpr double kThickness = 0.002;  // of contact [m]
constexpr double kTouching = 0.0012;  // a gap in which it begins within a step or two [m]
constexpr double kHandRadius = 0.02;  // [m]
constexpr double kHandSpeed = 0.5;    // [m/s]
constexpr double kFar = 100.0;        // [m]
constexpr double kBodySize = 0.1;     // about [m]

bool is(const SceneChoice& choice, Factor factor, const char* value) {
  return value_of(choice, factor) == value;
}

bool has_plane(const SceneChoice& choice) {
  return is(choice, kFactorSurroundings, "plane") || is(choice, kFactorSurroundings, "box") ||
         is(choice, kFactorSurroundings, "two");
}

double extent_below(const SceneChoice& choice) {
  const BodyExtent extent = extent_of(choice);
  return is(choice, kFactorTilt, "any") ? extent.radius : extent.half_height;
}

/// Where the body's middle is, over what it may touch, told with length 1.
double middle_height(const SceneChoice& choice) {
  const double under = is(choice, kFactorSurroundings, "box")   ? 0.05
                       : is(choice, kFactorSurroundings, "two") ? 0.022
                                                                : 0.0;
  return under + extent_below(choice) + kTouching;
}

Eigen::Vector3d velocity_of(const SceneChoice& choice) {
  const std::string& s = value_of(choice, kFactorSurroundings);
  if (s == "drift") return {0.3, -0.2, 0.1};
  if (s == "fall") return {0.3, 0.0, 0.0};
  if (s == "plane" || s == "two") return {0.1, 0.0, -0.5};
  if (s == "box") return {0.0, 0.0, -2.0};
  if (s == "robot") return {0.0, 0.0, 0.5};
  return Eigen::Vector3d::Zero();
}

Eigen::Matrix3d tilt_of(const SceneChoice& choice) {
  if (is(choice, kFactorTilt, "any")) return GeneratedRandom(5).rotation();
  if (is(choice, kFactorTilt, "upside_down")) return Eigen::Vector3d(1, -1, -1).asDiagonal();
  return Eigen::Matrix3d::Identity();
}

/// Of the scene as it is planned, before it is told in another place.
Eigen::Isometry3d planned_place(const SceneChoice& choice) {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  if (is(choice, kFactorPlace, "turned")) place.linear() = GeneratedRandom(11).rotation();
  if (is(choice, kFactorPlace, "far")) place.translation() = Eigen::Vector3d(kFar, -kFar, kFar);
  return place;
}

double time_step_of(const SceneChoice& choice, const SceneTelling& telling) {
  if (telling.time_step > 0.0) return telling.time_step;
  // One that explicit steps take without being called unstable, as far as there is one.
  if (is(choice, kFactorSolver, "verlet")) {
    return is(choice, kFactorStep, "long") ? 1e-3 : is(choice, kFactorStep, "short") ? 1e-5 : 1e-4;
  }
  return is(choice, kFactorStep, "long") ? 0.02 : is(choice, kFactorStep, "short") ? 5e-4 : 5e-3;
}

class SceneWriter {
 public:
  SceneWriter(const SceneChoice& choice, const SceneTelling& telling, const std::string& robot)
      : choice_(choice),
        telling_(telling),
        robot_(robot),
        units_(telling.length),
        place_(telling.place * planned_place(choice)) {
    place_.translation() *= telling.length;
    effects_ = effects_of(choice, units_, has_plane(choice));
  }

  std::string text() const {
    std::string text =
        fmt::format("time_step: {:.17g}\nbodies:\n", time_step_of(choice_, telling_));
    text += main_body();
    if (is(choice_, kFactorSurroundings, "two")) text += other_body();
    if (telling_.has_bystander) text += bystander();
    text += "effects:\n" + effects();
    const std::string things = obstacles();
    if (!things.empty()) text += "obstacles:\n" + things;
    if (is(choice_, kFactorSurroundings, "robot")) text += robot();
    if (is(choice_, kFactorSurroundings, "two")) text += solver() + "\n";
    return text;
  }

 private:
  /// "position: [...], rotation_rpy: [...]" of something that the scene has at `local`, in lengths
  /// of telling 1.
  std::string pose(const Eigen::Isometry3d& local) const {
    Eigen::Isometry3d scaled = local;
    scaled.translation() *= telling_.length;
    Eigen::Isometry3d pose = place_ * scaled;
    // What is there looks the same in the mirror y -> -y, or has a mesh that is mirrored so.
    if (telling_.is_mirrored()) pose.linear().col(1) *= -1.0;
    const Eigen::Vector3d p = pose.translation(), a = pose.linear().eulerAngles(2, 1, 0);
    return fmt::format(
        "position: [{:.17g}, {:.17g}, {:.17g}], rotation_rpy: [{:.17g}, {:.17g}, {:.17g}]", p.x(),
        p.y(), p.z(), a[2], a[1], a[0]);
  }
  std::string pose(double x, double z) const {
    return pose(Eigen::Isometry3d(Eigen::Translation3d(x, 0, z)));
  }
  std::string vector(const Eigen::Vector3d& v) const {
    const Eigen::Vector3d there = telling_.length * (place_.linear() * v);
    return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", there.x(), there.y(), there.z());
  }

  std::string solver() const {
    if (!telling_.solver.empty()) return fmt::format("solver: {{{}}}", telling_.solver);
    const std::string& name = value_of(choice_, kFactorSolver);
    if (name == "default") return "";
    std::string iterations;
    for (const ParameterSpec& parameter : find_solver(name).parameters) {
      if (parameter.name != "iterations") continue;
      if (is(choice_, kFactorIterations, "one")) iterations = ", iterations: 1";
      if (is(choice_, kFactorIterations, "zero")) {
        iterations = fmt::format(", iterations: {}", std::max(0.0, parameter.min));
      }
      if (is(choice_, kFactorIterations, "many")) iterations = ", iterations: 100";
    }
    return fmt::format("solver: {{name: {}{}}}", name, iterations);
  }

  std::string main_body() const {
    Eigen::Isometry3d local(Eigen::Translation3d(0, 0, middle_height(choice_)));
    // Turned too: what is exactly parallel is decided by round-off.
    const Eigen::Vector3d axis = Eigen::Vector3d(3, -2, 1).normalized();
    local.linear() = Eigen::AngleAxisd(telling_.nudge, axis) * tilt_of(choice_);
    // The origin of the reduced beam is at its fixed end.
    if (is(choice_, kFactorModel, "reduced")) {
      local.translation() += Eigen::Vector3d(-0.5 * kBodySize, 0, 0);
    }
    const double d = telling_.nudge * kBodySize;
    local.translation() += d * Eigen::Vector3d(0.9, -0.7, 0.4);
    // Bodies that may touch take one solver, as far as it moves them.
    const bool is_alone = !is(choice_, kFactorSurroundings, "two");
    std::string more = is_alone && !solver().empty() ? ", " + solver() : "";
    if (!is(choice_, kFactorIntegration, "default")) {
      more += ", time_integration: " + value_of(choice_, kFactorIntegration);
    }
    if (is(choice_, kFactorSurroundings, "pinned")) more += ", fixed: [{vertices: [0, 1, 2, 3]}]";
    if (is(choice_, kFactorSurroundings, "held")) {
      more += fmt::format(", attachments: [{{name: hold, vertices: {}, stiffness: {}}}]",
                          is(choice_, kFactorModel, "reduced") ? "[100, 101, 102]" : "[0, 1, 2, 3]",
                          units_(200.0, 1, 0));
    }
    return fmt::format("  - {{name: main, model: {}, {}, {}, velocity: {}{}}}\n",
                       value_of(choice_, kFactorModel),
                       body_text(choice_, units_, {telling_.mesh, telling_.is_mirrored()}),
                       pose(local), vector(velocity_of(choice_)), more);
  }
  std::string other_body() const {
    return fmt::format(
        "  - {{name: other, model: rigid, geometry: {{box: {{size: [{0}, {0}, {1}]}}, "
        "contact_spacing: {1}}}, material: {{density: {2}}}, {3}}}\n",
        units_(0.12, 0, 1), units_(0.02, 0, 1), units_(1000.0, 1, -3), pose(0, 0.0112));
  }
  std::string bystander_model() const {
    return is(choice_, kFactorModel, "cloth") ? "viscoelastic" : "cloth";
  }
  std::string bystander() const {
    const std::string body =
        is(choice_, kFactorModel, "cloth")
            ? fmt::format("geometry: {{block: {{size: [{0}, {0}, {0}]}}, particles: 27}}",
                          units_(0.03, 0, 1))
            : fmt::format("geometry: {{grid: {{size: [{0}, {0}], vertices: [4, 4]}}}}",
                          units_(0.03, 0, 1));
    return fmt::format("  - {{name: bystander, model: {}, {}, {}}}\n", bystander_model(), body,
                       pose(2.0, 3.0));
  }

  static std::string line(const std::string& name, const std::string& parameters) {
    return fmt::format("  {}: {{{}}}\n", name, parameters);
  }
  std::string effects() const {
    const double g = facts_of(choice_).has_gravity ? -kGeneratedGravity : 0.0;
    std::string text = line("gravity", "acceleration: " + vector({0, 0, g}));
    for (const EffectText& effect : effects_) text += line(effect.name, effect.parameters);
    const std::string contact =
        fmt::format("thickness: {}, margin: {}", units_(kThickness, 0, 1), units_(0.0005, 0, 1));
    if (!obstacles().empty() || is(choice_, kFactorSurroundings, "robot")) {
      text += line("contact", contact) + line("friction", "coefficient: 0.4");
    }
    if (is(choice_, kFactorSurroundings, "two")) {
      text += line("body_contact", contact + ", friction: 0.4");
    }
    if (!telling_.has_bystander) return text;
    for (const EffectText& effect : other_effects(bystander_model(), units_, effects_)) {
      text += line(effect.name, effect.parameters + ", bodies: [bystander]");
    }
    return text;
  }

  std::string obstacles() const {
    std::string text;
    if (has_plane(choice_)) {
      text += fmt::format("  - {{name: floor, shape: plane, {}}}\n", pose(0, 0));
    }
    if (is(choice_, kFactorSurroundings, "box")) {
      text += fmt::format("  - {{name: box, shape: box, size: [{0}, {0}, {0}], {1}}}\n",
                          units_(0.05, 0, 1), pose(0, 0.025));
    }
    if (is(choice_, kFactorSurroundings, "hand")) {
      text += fmt::format("  - {{name: hand, shape: sphere, radius: {}, {}}}\n",
                          units_(kHandRadius, 0, 1), pose(0, hand_height(choice_)));
    }
    return text;
  }
  std::string robot() const {
    // With its joints at 0 the tip of the finger, which points down, is where its base is.
    const double tip = middle_height(choice_) + extent_below(choice_) + 2 * kTouching;
    return fmt::format("robot: {{urdf: {}, {}}}\n", robot_, pose(0, tip));
  }

 public:
  static double hand_height(const SceneChoice& choice) {
    return middle_height(choice) + extent_below(choice) + kHandRadius + 2 * kTouching;
  }

 private:
  const SceneChoice& choice_;
  const SceneTelling& telling_;
  const std::string& robot_;
  SceneUnits units_;
  Eigen::Isometry3d place_;
  std::vector<EffectText> effects_;
};

/// Takes the obstacle `hand` straight on.
class HandDriver : public ObstacleDriver {
 public:
  HandDriver(const Eigen::Isometry3d& start, const Eigen::Vector3d& velocity)
      : start_(start), velocity_(velocity) {}
  void drive(double time, std::vector<Obstacle>& obstacles) override {
    for (Obstacle& obstacle : obstacles) {
      if (obstacle.name != "hand") continue;
      obstacle.pose_end = Eigen::Translation3d(time * velocity_) * start_;
    }
  }

 private:
  Eigen::Isometry3d start_;
  Eigen::Vector3d velocity_;
};

/// What no scene file can say: a body that does not begin at its rest shape, or turns.
void apply_start(const SceneChoice& choice, const Eigen::Matrix3d& turn, double length,
                 Particles& p) {
  const std::string& start = value_of(choice, kFactorStart);
  if (start == "rest") return;
  GeneratedRandom random(3);
  const Eigen::Vector3d center = p.center_of_mass();
  const Eigen::Matrix3d stretch =
      turn * Eigen::Vector3d(1.1, 1.0, 0.95).asDiagonal() * turn.transpose();
  // An axis: in the mirror it turns the other way round.
  const Eigen::Vector3d spin = turn.determinant() * (turn * Eigen::Vector3d(3, -5, 8));
  for (int i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d moved = turn * random.vector(0.001 * length);
    const Eigen::Vector3d gained = turn * random.vector(0.1 * length);
    if (p.is_fixed(i)) continue;
    const Eigen::Vector3d r = p.x.col(i) - center;
    if (start == "stretched") p.x.col(i) = center + stretch * r;
    if (start == "spinning") p.v.col(i) += spin.cross(r);
    if (start != "shaken") continue;
    p.x.col(i) += moved;
    p.v.col(i) += gained;
  }
}

/// Each particle in another direction, by up to `distance` [m].
void nudge(double distance, Particles& p) {
  GeneratedRandom random(29);
  for (int i = 0; i < p.size(); ++i) {
    const Eigen::Vector3d displacement = random.vector(distance);
    if (!p.is_fixed(i)) p.x.col(i) += displacement;
  }
}

}  // namespace

SceneFacts facts_of(const SceneChoice& choice) {
  const std::string& s = value_of(choice, kFactorSurroundings);
  const std::string& model = value_of(choice, kFactorModel);
  const std::vector<EffectText> effects = effects_of(choice, SceneUnits(1.0), has_plane(choice));
  SceneFacts facts;
  facts.size = 2.0 * extent_of(choice).radius;
  facts.time_step = time_step_of(choice, {});
  facts.steps = is(choice, kFactorStep, "long") ? 4 : 6;
  facts.has_gravity = s != "nothing" && s != "drift" && s != "hand";
  facts.has_obstacles = has_plane(choice) || s == "hand" || s == "robot";
  facts.is_held = s == "pinned" || s == "held" || model == "reduced";
  facts.is_pushed = s == "hand" || has_effect(effects, "air");
  facts.has_liquid =
      model == "viscoelastic" && (choice[kFactorFlags] >= 2 || has_effect(effects, "heat"));
  facts.loses_momentum = has_effect(effects, "damping") || has_effect(effects, "wetness");
  // A tube of cloth is bent, and springs open a little. Particles of a liquid are pushed apart
  // where they are a little too near each other.
  const bool is_bent = model == "cloth" && is(choice, kFactorShape, "second");
  facts.is_quiet = s == "nothing" && is(choice, kFactorStart, "rest") && !facts.has_liquid &&
                   !is_bent && !has_effect(effects, "surface_tension");
  facts.begins_beyond_limit =
      has_effect(effects, "strain_limit") && !is(choice, kFactorStart, "rest");
  facts.may_blow_up = is(choice, kFactorSolver, "imex_thesis") ||
                      is(choice, kFactorSolver, "stoermer_verlet") ||
                      is(choice, kFactorSolver, "newmark") || is(choice, kFactorSolver, "verlet");
  facts.may_have_bystander = choice[kFactorSelfContact] == 0 && s != "two";
  // The space of a reduced body is spanned by its modes, in units of one over the root of a mass,
  // and their derivatives: how much each of them counts depends on the unit.
  // Overlaps open at speeds that are the same at every size.
  const bool may_touch = facts.has_obstacles || choice[kFactorSelfContact] > 0;
  facts.may_be_rescaled = !may_touch && model != "reduced";
  // Points of solids that touch are scattered over their faces.
  facts.may_be_mirrored =
      may_be_read(choice) && s != "robot" && s != "two" && (model == "cloth" || !may_touch);
  facts.is_smooth = !may_touch && s != "two" && model != "rigid" && !facts.has_liquid &&
                    !is(choice, kFactorSolver, "shape_matching") &&
                    (choice[kFactorEffects] <= 1 || model == "reduced");
  facts.has_reference = (model == "cloth" || model == "patch") && s != "two";
  return facts;
}

double resolved_time_step(const SceneChoice& choice) {
  constexpr double kCell = 0.01, kOfCell = 0.1;  // [m]
  constexpr double kLongest = 5e-4;              // [s]
  const double speed = wave_speed(choice);
  return speed > 0.0 ? std::min(kLongest, kOfCell * kCell / speed) : kLongest;
}

void write_generated_mesh(const SceneChoice& choice, const std::string& robot, bool is_mirrored,
                          const std::string& path) {
  const LoadedScene scene = make_generated(choice, {}, robot);
  const GeometrySpec& spec = scene.spec.bodies.front().geometry;
  BodyGeometry geometry;
  if (spec.grid) {
    geometry.mesh = make_grid(*spec.grid);
  } else {
    const GeometryKind& kind = find_geometry_kind(spec.kind, value_of(choice, kFactorModel));
    geometry = kind.make(spec.path, spec.size, spec.options);
  }
  if (geometry.tetrahedra) {
    if (is_mirrored) geometry.tetrahedra->vertices.row(1) *= -1.0;
    write_msh(path, *geometry.tetrahedra);
  } else {
    if (is_mirrored) geometry.mesh.vertices.row(1) *= -1.0;
    write_obj(path, geometry.mesh);
  }
}

Eigen::Vector3d gravity_of(const SceneChoice& choice, const SceneTelling& telling) {
  const double g = facts_of(choice).has_gravity ? -kGeneratedGravity : 0.0;
  const Eigen::Matrix3d turn = (telling.place * planned_place(choice)).linear();
  return telling.length * (turn * Eigen::Vector3d(0, 0, g));
}

std::string scene_text(const SceneChoice& choice, const SceneTelling& telling,
                       const std::string& robot) {
  return SceneWriter(choice, telling, robot).text();
}

LoadedScene make_generated(const SceneChoice& choice, const SceneTelling& telling,
                           const std::string& robot) {
  SceneOverrides overrides;
  overrides.text = scene_text(choice, telling, robot);
  overrides.keeps_threads = true;
  LoadedScene scene = load_scene("generated.yaml", overrides);
  World& world = *scene.world;
  const Eigen::Matrix3d turn = (telling.place * planned_place(choice)).linear();
  for (const Obstacle& obstacle : world.obstacles()) {
    if (obstacle.name != "hand") continue;
    const Eigen::Vector3d velocity = turn * Eigen::Vector3d(0, 0, -kHandSpeed * telling.length);
    world.add_driver(std::make_unique<HandDriver>(obstacle.pose_end, velocity));
  }
  // Vertices of rigid and reduced bodies follow from fewer numbers.
  const std::string& model = value_of(choice, kFactorModel);
  if (model != "rigid" && model != "reduced") {
    Particles& particles = world.bodies().front().particles();
    apply_start(choice, turn, telling.length, particles);
    if (telling.nudge > 0.0) nudge(telling.nudge * kBodySize * telling.length, particles);
  }
  return scene;
}

}  // namespace pliant
