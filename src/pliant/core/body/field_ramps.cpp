#include "pliant/core/body/field_ramps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pliant/core/body.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

/// An effect's field hides the model's of the same name.
std::vector<SettableField> fields_of(const Body& body) {
  std::vector<SettableField> fields;
  const auto add = [&fields](std::vector<SettableField> more) {
    for (SettableField& field : more) {
      const bool is_hidden = std::any_of(fields.begin(), fields.end(), [&](const auto& other) {
        return other.spec.name == field.spec.name;
      });
      if (!is_hidden) fields.push_back(std::move(field));
    }
  };
  for (const auto& effect : body.effects) add(effect->settable_fields());
  add(body.model->settable_fields());
  return fields;
}

std::optional<SettableField> find_field(const Body& body, const std::string& name) {
  for (SettableField& field : fields_of(body)) {
    if (field.spec.name == name) return std::move(field);
  }
  return {};
}

/// Whether a request means the body of index `b`, where it names one by its index.
bool is_meant(int body, std::size_t b) { return body < 0 || body == static_cast<int>(b); }

double nearest_particle(const FieldRequest& request, const std::deque<Body>& bodies) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Positions& x = bodies[b].particles().x;
    if (x.cols() == 0 || !is_meant(request.body, b)) continue;
    const double own = (x.colwise() - request.region.center).colwise().norm().minCoeff();
    nearest = std::min(nearest, own);
  }
  return nearest;
}

void check(const FieldRequest& request, const SettableField& field) {
  if (!field.why_not.empty()) {
    throw InputError(
        fmt::format("set_field: '{}' cannot be set: {}", request.field, field.why_not));
  }
  parse_parameters({field.spec}, {{request.field, fmt::format("{:.17g}", request.value)}},
                   "set_field");
  if (!(request.duration >= 0.0 && std::isfinite(request.duration))) {
    throw InputError(
        fmt::format("set_field: 'duration' is {} s, but must be 0 (at once) or positive and finite",
                    request.duration));
  }
}

std::string no_particles(const FieldRequest& request, const std::deque<Body>& bodies) {
  if (request.region.kind != Region::Kind::kSphere) return "set_field: no vertex is in the region";
  const Eigen::Vector3d& c = request.region.center;
  return fmt::format(
      "set_field: no vertex of a body that has '{}' is within {:g} m of ({:g}, {:g}, {:g}) m; the "
      "nearest vertex is {:g} m away",
      request.field, request.region.radius, c.x(), c.y(), c.z(), nearest_particle(request, bodies));
}

}  // namespace

bool has_field(const Body& body, const std::string& name) {
  return find_field(body, name).has_value();
}

std::vector<std::string> settable_field_names(const std::deque<Body>& bodies, int body) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!is_meant(body, b)) continue;
    for (const SettableField& field : fields_of(bodies[b])) {
      if (!field.why_not.empty()) continue;
      if (std::find(names.begin(), names.end(), field.spec.name) == names.end()) {
        names.push_back(field.spec.name);
      }
    }
  }
  return names;
}

int FieldRamps::begin(const FieldRequest& request, std::deque<Body>& bodies, double time) {
  std::vector<Ramp> begun;
  bool is_known = false;
  int count = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!is_meant(request.body, b)) continue;
    const std::optional<SettableField> field = find_field(bodies[b], request.field);
    if (!field) continue;
    is_known = true;
    check(request, *field);
    const Positions& x = bodies[b].particles().x;
    Ramp ramp{b, request.field, request.value, time, time + request.duration, {}};
    for (int i : particles_in(request.region, x, 0, static_cast<int>(x.cols()))) {
      ramp.from.push_back({i, field->value(i)});
    }
    count += static_cast<int>(ramp.from.size());
    if (!ramp.from.empty()) begun.push_back(std::move(ramp));
  }
  if (!is_known) {
    const std::vector<std::string> names = settable_field_names(bodies, request.body);
    const std::string none = request.body < 0
                                 ? "no body of this scene has a field to set"
                                 : fmt::format("body '{}' has no field to set",
                                               bodies[static_cast<std::size_t>(request.body)].name);
    throw InputError("set_field: " +
                     (names.empty() ? none : unknown_name_message("field", request.field, names)));
  }
  if (count == 0) throw InputError(no_particles(request, bodies));
  for (const Ramp& ramp : begun) forget(ramp);
  ramps_.insert(ramps_.end(), begun.begin(), begun.end());
  if (request.duration == 0.0) advance(bodies, time);
  return count;
}

void FieldRamps::forget(const Ramp& replaced) {
  std::vector<int> particles;
  for (const Start& start : replaced.from) particles.push_back(start.particle);
  std::sort(particles.begin(), particles.end());
  const auto is_replaced = [&](const Start& start) {
    return std::binary_search(particles.begin(), particles.end(), start.particle);
  };
  for (Ramp& ramp : ramps_) {
    if (ramp.body != replaced.body || ramp.field != replaced.field) continue;
    ramp.from.erase(std::remove_if(ramp.from.begin(), ramp.from.end(), is_replaced),
                    ramp.from.end());
  }
}

void FieldRamps::advance(std::deque<Body>& bodies, double time) {
  // Times that differ by round-off are the same.
  const auto is_over = [time](const Ramp& ramp) { return ramp.end <= time * (1.0 + 1e-12); };
  for (const Ramp& ramp : ramps_) {
    const std::optional<SettableField> field = find_field(bodies[ramp.body], ramp.field);
    if (!field || !field->why_not.empty()) continue;
    const double share = is_over(ramp) ? 1.0 : (time - ramp.begin) / (ramp.end - ramp.begin);
    for (const Start& start : ramp.from) {
      field->set(start.particle, (1.0 - share) * start.value + share * ramp.value);
    }
  }
  ramps_.erase(std::remove_if(ramps_.begin(), ramps_.end(), is_over), ramps_.end());
}

}  // namespace pliant
