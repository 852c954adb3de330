#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "pliant/effects/attachment.h"
#include "pliant/math/error.h"
#include "pliant/ros/interactive/nearest_body.h"
#include "pliant/ros/running/simulation.h"

namespace pliant {
namespace {

bool is_taken(World& world, const std::string& name) {
  return std::any_of(world.bodies().begin(), world.bodies().end(), [&](Body& body) {
    const AttachmentEffect* effect = find_attachments(body);
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

/// Of some bodies the nearest to a region's centre that has vertices to hold there.
std::size_t body_to_hold(World& world, const std::vector<std::size_t>& bodies,
                         const Region& region) {
  std::optional<NearestBody> nearest;
  double nearest_vertex = std::numeric_limits<double>::infinity();
  for (const std::size_t b : bodies) {
    const Body& body = world.bodies()[b];
    const double distance = distance_to(body, region.center);
    nearest_vertex = std::min(nearest_vertex, distance);
    const bool is_nearer = !nearest || distance < nearest->distance;
    if (is_nearer && free_vertices(body, region) > 0) nearest = NearestBody{b, distance};
  }
  if (nearest) return nearest->body;
  throw InputError(fmt::format(
      "attach: no vertex that may move is within {:g} m of ({:g}, {:g}, {:g}) m; the "
      "nearest vertex is {:g} m away",
      region.radius, region.center.x(), region.center.y(), region.center.z(), nearest_vertex));
}

}  // namespace

Answer Simulation::attach(std::string name, const Region& region, const std::string& to,
                          double stiffness, const std::string& body) {
  World& world = this->world();
  const std::vector<std::size_t> candidates = names_.find("attach", body);
  if (name.empty()) name = free_name(world);
  if (is_taken(world, name)) {
    throw InputError(fmt::format("attach: the name '{}' is taken by another attachment", name));
  }
  AttachmentRequest request;
  request.name = name;
  request.region = region;
  request.obstacle = find_holder(to, world.obstacles());
  request.stiffness = stiffness;
  const std::size_t held = body_to_hold(world, candidates, region);
  Body& held_body = world.bodies()[held];
  request.count = held_body.particles().size();
  const int count =
      attachments_of(held_body, world.obstacles()).attach_now(request, world.time_step());
  return {true,
          fmt::format("'{}' holds {} vertices of {} to {}", name, count, names_.text({held}), to),
          world.time()};
}

Answer Simulation::detach(const std::string& name, const std::string& body) {
  World& world = this->world();
  const std::vector<std::size_t> meant = names_.find("detach", body);
  std::vector<std::string> there, let_go;
  for (const std::size_t b : meant) {
    AttachmentEffect* effect = find_attachments(world.bodies()[b]);
    if (effect == nullptr) continue;
    for (const std::string& own : effect->names()) {
      there.push_back(own);
      if (!name.empty() && own != name) continue;
      effect->detach(own, world.time_step());
      let_go.push_back(own + " of " + names_.text({b}));
    }
  }
  if (!name.empty() && let_go.empty()) {
    throw InputError("detach: " + unknown_name_message("attachment", name, there));
  }
  const std::string none = "nothing was held of " + names_.text(meant);
  const std::string text = fmt::format("let go: {}", fmt::join(let_go, ", "));
  return {true, let_go.empty() ? none : text, world.time()};
}

}  // namespace pliant
