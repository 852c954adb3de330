#include "pliant/scene/body_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "pliant/effects/registry.h"
#include "pliant/math/error.h"
#include "pliant/solvers/iterations/lockstep.h"

namespace pliant {
namespace {

const char* const kEffect = "body_contact";

bool is_acted_on(const Body& body) {
  const auto& models = effect_registry().find(kEffect).models;
  return std::find(models.begin(), models.end(), body.model->name()) != models.end();
}

/// Whether a scene's body `name` is one of those that were joined as `body` ("one+other").
bool is_part(const std::string& name, const Body& body) {
  std::istringstream stream(body.name);
  for (std::string part; std::getline(stream, part, '+');) {
    if (part == name) return true;
  }
  return false;
}

const Body& find_body(const std::string& name, const World& world) {
  return *std::find_if(world.bodies().begin(), world.bodies().end(),
                       [&](const Body& body) { return is_part(name, body); });
}

[[noreturn]] void refuse(const BodyPairSpec& pair, const std::string& why) {
  throw InputError(fmt::format("{}: effects.{}: {}", pair.place.text(), kEffect, why));
}

struct TwoBodies {
  const Body &one, &other;
};

TwoBodies find_two(const BodyPairSpec& pair, const World& world) {
  const Body &one = find_body(pair.one, world), &other = find_body(pair.other, world);
  if (&one == &other) {
    refuse(pair, fmt::format("bodies '{}' and '{}' are moved as one body, '{}', within which "
                             "this effect does not act",
                             pair.one, pair.other, one.name));
  }
  return {one, other};
}

/// A pair of joined bodies is one of all that joined them: two scenes' pairs may be the same one.
void check_is_one(const TwoBodies& found, const BodyPairSpec& pair, const BodyPairs& pairs) {
  if (pairs.are_known(found.one, found.other)) {
    refuse(pair, fmt::format("bodies '{}' and '{}' are named already, since bodies of one model "
                             "are moved as one: name them once",
                             found.one.name, found.other.name));
  }
}

void add_pairs(const BodyPairsSpec& spec, World& world) {
  BodyPairs& pairs = world.body_pairs();
  for (const BodyPairSpec& pair : spec.touching) {
    const TwoBodies found = find_two(pair, world);
    check_is_one(found, pair, pairs);
    pairs.name(found.one, found.other, pair.numbers);
  }
  for (const BodyPairSpec& pair : spec.left_out) {
    const TwoBodies found = find_two(pair, world);
    check_is_one(found, pair, pairs);
    pairs.leave_out(found.one, found.other);
  }
  if (spec.only_named) pairs.touch_only_named();
}

/// The bodies that `first` may touch, by way of others too, in the world's order.
std::vector<Body*> bodies_around(Body& first, World& world) {
  std::vector<const Body*> open = {&first}, found = {&first};
  while (!open.empty()) {
    const Body& body = *open.back();
    open.pop_back();
    for (const Body& other : world.bodies()) {
      const bool is_new = std::find(found.begin(), found.end(), &other) == found.end();
      if (!is_new || !is_acted_on(other) || !world.body_pairs().may_touch(body, other)) continue;
      open.push_back(&other);
      found.push_back(&other);
    }
  }
  std::vector<Body*> ordered;
  for (Body& body : world.bodies()) {
    if (std::find(found.begin(), found.end(), &body) != found.end()) ordered.push_back(&body);
  }
  return ordered;
}

}  // namespace

void group_bodies(const SceneSpec& scene, World& world) {
  const bool acts = std::any_of(scene.effects.begin(), scene.effects.end(),
                                [](const auto& effect) { return effect.name == kEffect; });
  if (!acts) return;
  add_pairs(scene.body_pairs, world);
  std::vector<const Body*> done;
  for (Body& body : world.bodies()) {
    if (!is_acted_on(body) || std::find(done.begin(), done.end(), &body) != done.end()) continue;
    std::vector<Body*> bodies = bodies_around(body, world);
    done.insert(done.end(), bodies.begin(), bodies.end());
    if (bodies.size() > 1) world.group(std::move(bodies), make_lockstep);
  }
}

}  // namespace pliant
