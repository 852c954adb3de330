#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "pliant/effects/attachment.h"
#include "pliant/math/error.h"
#include "pliant/ros/simulation.h"

namespace pliant {
namespace {

AttachmentEffect* attachments_in(Body& body) {
  return dynamic_cast<AttachmentEffect*>(body.find_effect("attachment"));
}

bool is_taken(World& world, const std::string& name) {
  return std::any_of(world.bodies().begin(), world.bodies().end(), [&](Body& body) {
    const AttachmentEffect* effect = attachments_in(body);
    return effect != nullptr && effect->has(name);
  });
}

std::string free_name(World& world) {
  for (int n = 1;; ++n) {
    const std::string name = fmt::format("attachment_{}", n);
    if (!is_taken(world, name)) return name;
  }
}

int free_vertices(const Body& body, const Region& region) {
  const Particles& particles = body.particles();
  const std::vector<int> found = particles_to_hold(body, region, 0, particles.size());
  return static_cast<int>(
      std::count_if(found.begin(), found.end(), [&](int i) { return !particles.is_fixed(i); }));
}

double nearest_vertex(World& world, const Eigen::Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Body& body : world.bodies()) {
    const ForcePoints points = body.force_points();
    for (int i = 0; i < points.size(); ++i) {
      nearest = std::min(nearest, (points.position(i) - point).norm());
    }
  }
  return nearest;
}

}  // namespace

Answer Simulation::attach(std::string name, const Region& region, const std::string& to,
                          double stiffness) {
  World& world = this->world();
  if (name.empty()) name = free_name(world);
  if (is_taken(world, name)) {
    throw InputError(fmt::format("attach: the name '{}' is taken by another attachment", name));
  }
  const int obstacle = find_holder(to, world.obstacles());
  int count = 0;
  for (const Body& body : world.bodies()) count += free_vertices(body, region);
  if (count == 0) {
    throw InputError(
        fmt::format("attach: no vertex that may move is within {:g} m of ({:g}, {:g}, {:g}) m; the "
                    "nearest vertex is {:g} m away",
                    region.radius, region.center.x(), region.center.y(), region.center.z(),
                    nearest_vertex(world, region.center)));
  }
  for (Body& body : world.bodies()) {
    const int own = free_vertices(body, region);
    if (own == 0) continue;
    AttachmentRequest request;
    request.name = name;
    request.region = region;
    request.count = body.particles().size();
    request.obstacle = obstacle;
    request.stiffness = stiffness * own / count;
    attachments_of(body, world.obstacles()).attach_now(request, world.time_step());
  }
  return {true, fmt::format("'{}' holds {} vertices to {}", name, count, to), world.time()};
}

Answer Simulation::detach(const std::string& name) {
  World& world = this->world();
  std::vector<std::string> there, let_go;
  for (Body& body : world.bodies()) {
    AttachmentEffect* effect = attachments_in(body);
    if (effect == nullptr) continue;
    for (const std::string& own : effect->names()) {
      there.push_back(own);
      if (!name.empty() && own != name) continue;
      effect->detach(own, world.time_step());
      let_go.push_back(own);
    }
  }
  if (!name.empty() && let_go.empty()) {
    throw InputError("detach: " + unknown_name_message("attachment", name, there));
  }
  const std::string text = fmt::format("{}", fmt::join(let_go, ", "));
  return {true, let_go.empty() ? "nothing was held" : "let go: " + text, world.time()};
}

}  // namespace pliant
