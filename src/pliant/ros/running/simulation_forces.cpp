#include <fmt/format.h>

#include <algorithm>

#include "pliant/math/error.h"
#include "pliant/ros/interactive/nearest_body.h"
#include "pliant/ros/running/simulation.h"

namespace pliant {

Answer Simulation::apply_force(AppliedForce force, const ros::Time& start,
                               const std::string& body) {
  std::vector<std::size_t> meant = names_.find("apply_force", body);
  // What is not finite is near to nothing; the force is refused for it below.
  if (body.empty()) meant = {nearest_body(world().bodies(), force.point).body};
  const double delay = start.isZero() ? 0.0 : std::max(0.0, (start - now()).toSec());
  force.start = world().time() + delay;
  force.body = static_cast<int>(meant.front());
  world().applied_forces().add(force);
  const std::string end =
      force.duration < 0.0 ? "for good" : fmt::format("for {:g} s", force.duration);
  return {
      true,
      fmt::format("{:g} N on {} at ({:g}, {:g}, {:g}) m from {:.6g} s on, {}",
                  force.force.stableNorm(), names_.text(meant), force.point.x(), force.point.y(),
                  force.point.z(), force.start, force.duration == 0.0 ? "for one step" : end),
      world().time()};
}

Answer Simulation::clear_forces(const std::string& body) {
  const std::vector<std::size_t> meant = names_.find("clear_forces", body);
  int count = 0;
  for (const std::size_t b : meant) {
    count += world().applied_forces().clear(static_cast<int>(b));
  }
  return {true, fmt::format("{} cleared on {}", count, names_.text(meant)), world().time()};
}

Answer Simulation::set_field(FieldRequest request, const std::string& body) {
  std::vector<std::size_t> meant = names_.find("set_field", body);
  if (!body.empty()) request.body = static_cast<int>(meant.front());
  const std::deque<Body>& bodies = world().bodies();
  const auto has_none = [&](std::size_t b) {
    const Positions& x = bodies[b].particles().x;
    return !has_field(bodies[b], request.field) ||
           particles_in(request.region, x, 0, static_cast<int>(x.cols())).empty();
  };
  meant.erase(std::remove_if(meant.begin(), meant.end(), has_none), meant.end());
  const int count = world().set_field(request);
  const std::string how =
      request.duration == 0.0 ? "at once" : fmt::format("within {:g} s", request.duration);
  return {true,
          fmt::format("'{}' of {} vertices of {} becomes {:g} {}", request.field, count,
                      names_.text(meant), request.value, how),
          world().time()};
}

}  // namespace pliant
