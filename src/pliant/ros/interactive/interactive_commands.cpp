#include "pliant/ros/interactive/interactive_commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "pliant/core/body/field_ramps.h"
#include "pliant/effects/attachment.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

// A push takes a body that nothing holds to 1 m/s.
constexpr double kPushAcceleration = 10.0;  // [m/s²]
constexpr double kPushDuration = 0.1;       // [s]
// What is attached stays within a millimetre under its own weight.
constexpr double kAttachmentSag = 1e-3;   // [m]
constexpr double kWeightPerMass = 9.81;   // [N/kg]
constexpr double kWarming = 50.0;         // by one choice of the menu [K]
constexpr double kWarmingDuration = 1.0;  // [s]

Body& body_at(Simulation& simulation, std::size_t body) {
  return simulation.world().bodies()[body];
}

bool can_be_pinned(const Body& body) {
  return body.model->why_not_fix().empty() && body.model->system().as_projective() != nullptr;
}

/// Outward of a solid at the surface's vertex nearest to a point; of a sheet the side that looks
/// up.
Eigen::Vector3d normal_at(const Body& body, const Eigen::Vector3d& point) {
  const TriangleMesh surface = body.model->surface();
  double nearest = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  for (const auto t : surface.triangles.colwise()) {
    const Eigen::Vector3d a = surface.vertices.col(t[0]), b = surface.vertices.col(t[1]),
                          c = surface.vertices.col(t[2]);
    const double distance = ((a + b + c) / 3.0 - point).squaredNorm();
    const Eigen::Vector3d area = (b - a).cross(c - a);
    if (!(distance < nearest) || !(area.norm() > 0.0)) continue;
    nearest = distance;
    normal = area.normalized();
  }
  if (!body.model->is_solid() && normal.z() < 0.0) normal = -normal;
  return normal;
}

Answer attach(Simulation& simulation, std::size_t b, const Region& region, const std::string& to) {
  const double mass = body_at(simulation, b).particles().mass.sum();
  return simulation.attach("", region, to, mass * kWeightPerMass / kAttachmentSag,
                           simulation.names().graph_name(b));
}

Answer pin(Simulation& simulation, std::size_t b, const Region& region) {
  Body& body = body_at(simulation, b);
  Particles& particles = body.particles();
  const std::vector<int> found = free_particles_to_hold(body, region, 0, particles.size());
  for (const int i : found) {
    particles.fix(i);
    particles.v.col(i).setZero();
  }
  prepare_again(body, simulation.world().time_step());
  return {true, fmt::format("pinned {} vertices of {}", found.size(), simulation.names().text({b})),
          simulation.world().time()};
}

Answer push(Simulation& simulation, std::size_t b, const Eigen::Vector3d& point, double radius) {
  const Body& body = body_at(simulation, b);
  AppliedForce force;
  force.point = point;
  force.radius = radius;
  force.force = -body.particles().mass.sum() * kPushAcceleration * normal_at(body, point);
  force.duration = kPushDuration;
  return simulation.apply_force(force, ros::Time(), simulation.names().graph_name(b));
}

Answer set_field(Simulation& simulation, std::size_t b, const Region& region,
                 const std::string& field, double value, double duration) {
  FieldRequest request;
  request.field = field;
  request.region = region;
  request.value = value;
  request.duration = duration;
  return simulation.set_field(request, simulation.names().graph_name(b));
}

Answer warm(Simulation& simulation, std::size_t b, const Region& region, double by) {
  const Body& body = body_at(simulation, b);
  const auto fields = body.model->point_fields();
  const Eigen::VectorXd& temperature = fields.at("temperature");
  const std::vector<int> near =
      particles_in(region, body.particles().x, 0, body.particles().size());
  double mean = 0.0;
  for (const int i : near) mean += temperature[i] / static_cast<double>(near.size());
  return set_field(simulation, b, region, "temperature", std::max(0.0, mean + by),
                   kWarmingDuration);
}

/// What users pinned and attached since the last reset.
Answer release(Simulation& simulation, std::size_t b) {
  Body& body = body_at(simulation, b);
  Particles& particles = body.particles();
  int count = 0;
  for (int i = 0; i < particles.size(); ++i) {
    if (!particles.is_fixed(i) || body.initial.is_fixed(i)) continue;
    particles.release(i);
    ++count;
  }
  if (count > 0) prepare_again(body, simulation.world().time_step());
  Answer answer = simulation.detach("", simulation.names().graph_name(b));
  if (count > 0) answer.message += fmt::format("; released {} pinned vertices", count);
  return answer;
}

}  // namespace

Eigen::Vector3d grab(Simulation& simulation, std::size_t body, const Eigen::Vector3d& point,
                     const MouseTool& tool) {
  Body& meant = body_at(simulation, body);
  const Region region = region_to_grab(meant, point, tool.radius);
  DragEffect& drag = drag_of(meant);
  drag.grab(region, tool.spring, simulation.world().time_step());
  return drag.center();
}

void drag_to(Simulation& simulation, std::size_t body, const Eigen::Vector3d& center) {
  DragEffect& drag = drag_of(body_at(simulation, body));
  if (drag.is_holding()) drag.move_to(center);
}

void let_go(Simulation& simulation, std::size_t body) {
  drag_of(body_at(simulation, body)).let_go(simulation.world().time_step());
}

std::vector<BodyAction> actions_of(const World& world, std::size_t body) {
  const std::vector<std::string> fields =
      settable_field_names(world.bodies(), static_cast<int>(body));
  const auto has = [&](const char* field) {
    return std::find(fields.begin(), fields.end(), field) != fields.end();
  };
  std::vector<BodyAction> actions = {BodyAction::kAttach};
  if (can_be_pinned(world.bodies()[body])) actions.push_back(BodyAction::kPin);
  actions.push_back(BodyAction::kPush);
  if (has("temperature")) {
    actions.push_back(BodyAction::kHeat);
    actions.push_back(BodyAction::kCool);
  }
  if (has("wetness")) {
    actions.push_back(BodyAction::kWet);
    actions.push_back(BodyAction::kDry);
  }
  actions.push_back(BodyAction::kRelease);
  return actions;
}

std::string title_of(BodyAction action) {
  switch (action) {
    case BodyAction::kAttach:
      return "Attach here";
    case BodyAction::kPin:
      return "Pin here";
    case BodyAction::kPush:
      return "Push here";
    case BodyAction::kHeat:
      return "Heat here by 50 K";
    case BodyAction::kCool:
      return "Cool here by 50 K";
    case BodyAction::kWet:
      return "Wet here";
    case BodyAction::kDry:
      return "Dry here";
    case BodyAction::kRelease:
      return "Release pins and attachments";
  }
  return "";
}

Answer act(Simulation& simulation, std::size_t body, BodyAction action,
           const Eigen::Vector3d& point, const MouseTool& tool, const std::string& to) {
  if (action == BodyAction::kRelease) return release(simulation, body);
  const Region region = region_to_grab(body_at(simulation, body), point, tool.radius);
  switch (action) {
    case BodyAction::kAttach:
      return attach(simulation, body, region, to);
    case BodyAction::kPin:
      return pin(simulation, body, region);
    case BodyAction::kPush:
      return push(simulation, body, point, tool.radius);
    case BodyAction::kHeat:
    case BodyAction::kCool:
      return warm(simulation, body, region, action == BodyAction::kHeat ? kWarming : -kWarming);
    case BodyAction::kWet:
    case BodyAction::kDry:
      return set_field(simulation, body, region, "wetness", action == BodyAction::kWet ? 1.0 : 0.0,
                       0.0);
    case BodyAction::kRelease:
      break;
  }
  return {};
}

}  // namespace pliant
