#include "pliant/scene/robot/scene_robots.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"
#include "pliant/scene/robot/motion/keyframe_file.h"
#include "pliant/scene/yaml/place_error.h"

namespace pliant {
namespace {

// Round-off of keyframes that go as fast as a joint may.
constexpr double kSpeedShare = 1.01;

/// Whether `robot_description` takes the place of this robot's `urdf`.
bool takes_description(const SceneSpec& scene, const RobotSpec& spec,
                       const SceneOverrides& overrides) {
  return overrides.robot_description.has_value() &&
         (scene.robots.size() == 1 || spec.urdf_path.empty());
}

std::shared_ptr<Robot> make_robot(const SceneSpec& scene, const RobotSpec& spec,
                                  const SceneOverrides& overrides) {
  const std::string where = spec.place.text() + ": " + spec.field;
  const bool has_text = takes_description(scene, spec, overrides);
  if (!has_text && spec.urdf_path.empty()) {
    throw InputError(
        where +
        ": 'urdf' is missing; give the path of a URDF file, or run the scene in a node "
        "that finds a 'robot_description'");
  }
  RobotOptions options;
  options.resolver = overrides.package_resolver;
  options.prefix = spec.prefix;
  options.touching = spec.touching;
  options.visual_shapes = spec.visual_shapes;
  options.limit_rule = spec.limit_rule;
  options.colliders = spec.colliders;
  auto robot = std::make_shared<Robot>(with_place(where, [&] {
    return has_text ? Robot::from_text(*overrides.robot_description, options)
                    : Robot::from_file(spec.urdf_path, options);
  }));
  robot->set_base_pose(spec.world_from_base);
  for (const auto& [joint, initial] : spec.initial) {
    with_place(
        initial.place.text() + ": " + spec.field + ".initial",
        [&, &name = joint, &value = initial.value] { robot->set_initial_position(name, value); });
  }
  if (spec.limit_efforts) robot->limit_efforts();
  for (const auto& [joint, effort] : spec.efforts) {
    with_place(effort.place.text() + ": " + spec.field + ".efforts",
               [&, &name = joint, &value = effort.value] { robot->limit_effort(name, value); });
  }
  return robot;
}

/// Sets `value` of the obstacles of each link that `values` names; `key` is their key in the scene.
template <class Set>
void set_of_links(const std::map<std::string, RobotSpec::NamedValue>& values, const RobotSpec& spec,
                  const char* key, std::vector<Obstacle>& obstacles, const Set& set) {
  std::vector<std::string> links;
  for (const Obstacle& obstacle : obstacles) {
    if (links.empty() || links.back() != obstacle.link) links.push_back(obstacle.link);
  }
  for (const auto& [link, given] : values) {
    const auto is_meant = [&, &name = link](const std::string& other) {
      return other == name || other == spec.prefix + name;
    };
    if (std::none_of(links.begin(), links.end(), is_meant)) {
      throw InputError(given.place.text() + ": " + spec.field + "." + key + ": " +
                       unknown_name_message("robot link with a collision shape", link, links));
    }
    for (Obstacle& obstacle : obstacles) {
      if (is_meant(obstacle.link)) set(obstacle, given.value);
    }
  }
}

std::vector<Obstacle> make_link_obstacles(const RobotSpec& spec, const Robot& robot) {
  std::vector<Obstacle> obstacles = robot.make_obstacles();
  for (Obstacle& obstacle : obstacles) {
    obstacle.friction = spec.friction;
    obstacle.temperature = spec.temperature;
  }
  set_of_links(spec.link_friction, spec, "link_friction", obstacles,
               [](Obstacle& obstacle, double value) { obstacle.friction = value; });
  set_of_links(spec.link_temperatures, spec, "link_temperatures", obstacles,
               [](Obstacle& obstacle, double value) { obstacle.temperature = value; });
  return obstacles;
}

/// Names that two robots share would make what is said of them mean two things.
void refuse_shared_names(const SceneSpec& spec, const std::vector<SceneRobot>& robots) {
  for (std::size_t a = 0; a < robots.size(); ++a) {
    for (std::size_t b = a + 1; b < robots.size(); ++b) {
      for (const std::string& link : robots[b].robot->link_names()) {
        if (!robots[a].robot->link_index(link)) continue;
        throw InputError(fmt::format("{}: {}: {} has a link '{}' too: give one of them a 'prefix'",
                                     spec.robots[b].place.text(), spec.robots[b].field,
                                     spec.robots[a].field, link));
      }
    }
  }
}

std::string quoted(const std::vector<std::string>& names) {
  return fmt::format("'{}'", fmt::join(names, "', '"));
}

/// Joints that keyframes leave out and that `initial` does not place.
std::string untold_warning(const RobotSpec& spec, const Robot& robot, const Keyframes& keyframes) {
  std::vector<bool> is_told(robot.joint_names().size(), false);
  const auto tell = [&](const std::string& joint) {
    is_told[static_cast<std::size_t>(robot.find_joint(joint))] = true;
  };
  for (const std::string& joint : keyframes.joints()) tell(joint);
  for (const auto& initial : spec.initial) tell(initial.first);
  std::vector<std::string> untold;
  for (std::size_t j = 0; j < is_told.size(); ++j) {
    if (!is_told[j]) untold.push_back(robot.joint_names()[j]);
  }
  if (untold.empty()) return "";
  return fmt::format(
      "{}: neither the keyframes nor '{}.initial' name{} {}: {} where the robot "
      "starts",
      spec.keyframes_place.text(), spec.field, untold.size() == 1 ? " joint" : " joints",
      quoted(untold), untold.size() == 1 ? "it stays" : "they stay");
}

void warn_of_keyframes(const RobotSpec& spec, const Robot& robot, const Keyframes& keyframes,
                       std::vector<std::string>& warnings) {
  const std::string place = spec.keyframes_place.text();
  for (std::size_t j = 0; j < keyframes.joints().size(); ++j) {
    const int joint = robot.find_joint(keyframes.joints()[j]);
    const std::string& name = robot.joint_names()[static_cast<std::size_t>(joint)];
    const Robot::Limits limits = robot.limits(joint);
    const auto row = keyframes.samples().positions.row(static_cast<Eigen::Index>(j));
    const bool is_beyond = row.minCoeff() < limits.lower || row.maxCoeff() > limits.upper;
    if (is_beyond && robot.limit_rule() != JointLimitRule::kIgnore) {
      warnings.push_back(fmt::format(
          "{}: keyframes put joint '{}' between {:g} and {:g} {}, but its limits are {:g} to {:g}: "
          "it {}",
          place, name, row.minCoeff(), row.maxCoeff(), robot.unit(joint), limits.lower,
          limits.upper,
          robot.limit_rule() == JointLimitRule::kClamp ? "stays within them" : "goes there"));
    }
    const Keyframes::Speed top = keyframes.top_speed(static_cast<int>(j));
    if (top.value > kSpeedShare * limits.velocity) {
      warnings.push_back(
          fmt::format("{}: keyframes move joint '{}' at up to {:.3g} {}/s, between {:g} and {:g} "
                      "s, but its URDF "
                      "allows {:g} {}/s",
                      place, name, top.value, robot.unit(joint), top.from, top.until,
                      limits.velocity, robot.unit(joint)));
    }
  }
  const std::string untold = untold_warning(spec, robot, keyframes);
  if (!untold.empty()) warnings.push_back(untold);
}

/// Of a robot whose joints shall stall, and none can.
void warn_of_efforts(const RobotSpec& spec, const Robot& robot,
                     std::vector<std::string>& warnings) {
  const int joints = static_cast<int>(robot.joint_names().size());
  for (int j = 0; j < joints; ++j) {
    if (std::isfinite(robot.effort(j))) return;
  }
  if (!spec.limit_efforts) return;
  warnings.push_back(fmt::format(
      "{}: {}.effort: no joint of robot '{}' has an effort above 0 in its URDF, so that "
      "none stalls: give them in '{}.efforts'",
      spec.place.text(), spec.field, robot.name(), spec.field));
}

void read_motion(const RobotSpec& spec, SceneRobot& robot) {
  with_place(spec.keyframes_place.text() + ": " + spec.field + ".keyframes", [&] {
    const Keyframes keyframes = read_keyframes(spec.keyframes_path, robot.robot.get());
    robot.keyframes = make_keyframe_source(keyframes, *robot.robot, spec.keyframes_path);
    warn_of_keyframes(spec, *robot.robot, keyframes, robot.warnings);
  });
}

void warn_of_tf(const RobotSpec& spec, const Robot& robot, std::vector<std::string>& warnings) {
  if (!spec.base_frame.empty()) {
    warnings.push_back(
        fmt::format("{}: '{}.base_frame' needs tf, which only a node has: here the base of robot "
                    "'{}' stays at its 'position'",
                    spec.base_frame_place.text(), spec.field, robot.name()));
  }
  for (const Robot::FreeJoint& joint : robot.free_joints()) {
    warnings.push_back(
        fmt::format("{}: {} joint '{}' of robot '{}' follows tf, which only a node has: here link "
                    "'{}' stays where the URDF puts it",
                    spec.place.text(), joint.type, joint.name, robot.name(), joint.child));
  }
}

/// Links that `links.include` names and that have no shape.
void warn_of_shapeless(const RobotSpec& spec, const Robot& robot, const World& world,
                       std::vector<std::string>& warnings) {
  for (const LinkChoice::Pattern& pattern : spec.touching.include) {
    for (const std::string& link : {pattern.text, spec.prefix + pattern.text}) {
      if (!robot.link_index(link)) continue;
      const bool has_shape =
          std::any_of(world.obstacles().begin(), world.obstacles().end(),
                      [&](const Obstacle& obstacle) { return obstacle.link == link; });
      if (!has_shape) {
        warnings.push_back(
            fmt::format("{}: {}.links: link '{}' has no collision shape and touches nothing{}",
                        pattern.place.text(), spec.field, link,
                        spec.visual_shapes ? "" : "; 'collision: visual' takes its visual one"));
      }
      break;
    }
  }
}

}  // namespace

Eigen::Isometry3d SceneRobot::link_pose(const std::string& link) const {
  const std::optional<int> index = robot->link_index(link);
  if (index && driver != nullptr) return driver->link_pose(*index);
  return robot->link_pose(link, robot->initial_positions());
}

std::vector<SceneRobot> add_robots(const SceneSpec& spec, const SceneOverrides& overrides,
                                   World& world) {
  std::vector<SceneRobot> robots;
  for (const RobotSpec& robot_spec : spec.robots) {
    SceneRobot added;
    added.robot = make_robot(spec, robot_spec, overrides);
    warn_of_efforts(robot_spec, *added.robot, added.warnings);
    for (Obstacle& obstacle : make_link_obstacles(robot_spec, *added.robot)) {
      world.add_obstacle(std::move(obstacle));
    }
    if (!robot_spec.keyframes_path.empty() && overrides.drive_robot_from_keyframes) {
      read_motion(robot_spec, added);
    }
    if (added.keyframes && !overrides.knows_tf) {
      auto driver = std::make_unique<RobotDriver>(added.robot, added.keyframes);
      added.driver = driver.get();
      world.add_driver(std::move(driver));
    }
    robots.push_back(std::move(added));
  }
  refuse_shared_names(spec, robots);
  return robots;
}

std::vector<std::string> robot_warnings(const LoadedScene& scene, const SceneOverrides& overrides) {
  std::vector<std::string> warnings;
  const World& world = *scene.world;
  bool is_described = false;
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const RobotSpec& spec = scene.spec.robots[r];
    const Robot& robot = *scene.robots[r].robot;
    is_described = is_described || takes_description(scene.spec, spec, overrides);
    warnings.insert(warnings.end(), robot.warnings().begin(), robot.warnings().end());
    const std::vector<std::string>& of_motion = scene.robots[r].warnings;
    warnings.insert(warnings.end(), of_motion.begin(), of_motion.end());
    if (!overrides.knows_tf) warn_of_tf(spec, robot, warnings);
    warn_of_shapeless(spec, robot, world, warnings);
    const bool touches = std::any_of(
        world.obstacles().begin(), world.obstacles().end(),
        [&](const Obstacle& obstacle) { return robot.link_index(obstacle.link).has_value(); });
    if (!touches) {
      warnings.push_back("robot '" + robot.name() +
                         "' has no collision shapes: it touches nothing; 'collision: visual' takes "
                         "its visual ones");
    }
  }
  if (overrides.robot_description && !is_described) {
    warnings.push_back(
        scene.robots.empty()
            ? "there is a 'robot_description', but the scene has no 'robot': no robot touches the "
              "bodies; write 'robot: {}' in " +
                  scene.spec.path
            : "there is a 'robot_description', but each robot of the scene has a 'urdf' of its "
              "own: "
              "it is not used");
  }
  return warnings;
}

}  // namespace pliant
