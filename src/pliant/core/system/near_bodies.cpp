#include "pliant/core/system/near_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/core/body.h"
#include "pliant/core/group.h"
#include "pliant/core/system/body_pairs.h"

namespace pliant {
namespace {

// Steps from one look to the next.
constexpr std::uint64_t kEvery = 10;

bool has_contact(const Body& body) { return body.find_effect("body_contact") != nullptr; }

bool are_kept_apart(const Body& a, const Body& b, const BodyPairs& pairs) {
  return a.group == b.group && has_contact(a) && has_contact(b) && pairs.may_touch(a, b);
}

std::string cure_of(const Body& a, const Body& b) {
  if (has_contact(a) && has_contact(b)) {
    return "name the two among the 'pairs' of 'body_contact', or under its 'except' to let them "
           "pass";
  }
  return "name 'body_contact' among the scene's 'effects'";
}

std::string warning_of(const Body& a, const Body& b) {
  return fmt::format(
      "bodies_pass: bodies '{}' and '{}' are near each other, and nothing keeps them apart: {}",
      a.name, b.name, cure_of(a, b));
}

}  // namespace

NearBodies::Surface NearBodies::surface_of(const Body& body) {
  Surface surface;
  // A surface that is made anew for each state costs more than a look is worth.
  if (body.model->surface_changes()) {
    surface.vertices = body.particles().x;
  } else {
    surface.vertices.resize(3, body.model->surface_vertices());
    body.model->surface_positions(surface.vertices);
  }
  if (surface.vertices.cols() == 0) return surface;
  surface.box.min() = surface.vertices.rowwise().minCoeff();
  surface.box.max() = surface.vertices.rowwise().maxCoeff();
  // About that of a surface around the box with so many vertices.
  const Eigen::Vector3d s = surface.box.sizes();
  const double area = 2.0 * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]);
  surface.spacing = std::sqrt(area / static_cast<double>(surface.vertices.cols()));
  return surface;
}

bool NearBodies::are_near(const Surface& a, const Surface& b) {
  const double reach = std::max(a.spacing, b.spacing);
  if (!(reach > 0.0) || !(a.box.exteriorDistance(b.box) <= reach)) return false;
  hash_.build(a.vertices, reach);
  for (const auto vertex : b.vertices.colwise()) {
    bool is_near = false;
    const Eigen::AlignedBox3d around(Eigen::Vector3d(vertex.array() - reach),
                                     Eigen::Vector3d(vertex.array() + reach));
    hash_.for_each_near(
        around, [&](int i) { is_near = is_near || (a.vertices.col(i) - vertex).norm() <= reach; });
    if (is_near) return true;
  }
  return false;
}

template <class Visit>
void NearBodies::for_each_near_pair(const std::deque<Body>& bodies, const BodyPairs& pairs,
                                    const Visit& visit) {
  std::vector<Surface> surfaces(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const std::pair<std::size_t, std::size_t> pair(a, b);
      if (are_kept_apart(bodies[a], bodies[b], pairs)) continue;
      if (pairs.is_left_out(bodies[a], bodies[b])) continue;
      if (std::find(told_.begin(), told_.end(), pair) != told_.end()) continue;
      for (const std::size_t k : {a, b}) {
        if (surfaces[k].spacing == 0.0) surfaces[k] = surface_of(bodies[k]);
      }
      if (are_near(surfaces[a], surfaces[b])) visit(pair);
    }
  }
}

void NearBodies::look(std::uint64_t step, std::deque<Body>& bodies, const BodyPairs& pairs) {
  if (bodies.size() < 2 || step % kEvery != 1) return;
  for_each_near_pair(bodies, pairs, [&](const auto& pair) {
    told_.push_back(pair);
    bodies[pair.first].report.warn(warning_of(bodies[pair.first], bodies[pair.second]));
  });
}

std::vector<std::string> NearBodies::find(const std::deque<Body>& bodies, const BodyPairs& pairs) {
  std::vector<std::string> found;
  for_each_near_pair(bodies, pairs, [&](const auto& pair) {
    found.push_back(warning_of(bodies[pair.first], bodies[pair.second]));
  });
  return found;
}

}  // namespace pliant
