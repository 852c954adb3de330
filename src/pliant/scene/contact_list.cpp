#include "pliant/scene/contact_list.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/effects/contact/contact.h"
#include "pliant/effects/contact/pair_contact_effect.h"
#include "pliant/models/viscoelastic/viscoelastic.h"

namespace pliant {
namespace {

/// Of a point that touches.
int main_particle(const ContactPoints& points, int point) {
  if (!points.are_embedded()) return point;
  Eigen::Index k = 0;
  points.embedded()->weights().col(point).cwiseAbs().maxCoeff(&k);
  return points.embedded()->particles()(k, point);
}

void list_of_obstacles(const ContactEffect& effect, const Body& body, TouchedPoint touch,
                       std::vector<TouchedPoint>& touched) {
  for (const Contact& contact : effect.contacts()) {
    touch.force = contact.normal_force * contact.normal + contact.friction_force;
    if (touch.force.isZero(0.0)) continue;
    touch.point = effect.points().position(body.particles().x, contact.point);
    touch.normal = contact.normal;
    touch.vertex = main_particle(effect.points(), contact.point);
    touch.obstacle = contact.obstacle;
    touched.push_back(touch);
  }
}

void list_of_walls(const ViscoelasticModel& model, const std::vector<Obstacle>& obstacles,
                   TouchedPoint touch, std::vector<TouchedPoint>& touched) {
  for (const LiquidWalls::Push& push : model.wall_pushes()) {
    touch.force = push.force;
    touch.point =
        push.arm + obstacles[static_cast<std::size_t>(push.obstacle)].pose_end.translation();
    touch.normal = push.normal;
    touch.vertex = push.particle;
    touch.obstacle = push.obstacle;
    touched.push_back(touch);
  }
}

/// Bodies whose particles lie side by side, and where those of each begin.
class Members {
 public:
  struct Member {
    const Body* body;
    int number;  // in the world
    int first;
  };
  Members(const std::vector<const Body*>& bodies, const World& world) {
    int first = 0;
    for (const Body* body : bodies) {
      const auto& all = world.bodies();
      const auto found =
          std::find_if(all.begin(), all.end(), [&](const Body& own) { return &own == body; });
      members_.push_back({body, static_cast<int>(found - all.begin()), first});
      first += body->particles().size();
    }
  }
  const Member& of(int particle) const {
    const auto next = std::find_if(members_.begin(), members_.end(),
                                   [&](const Member& member) { return member.first > particle; });
    return *std::prev(next);
  }

 private:
  std::vector<Member> members_;
};

/// What carries one of the two places of a pair.
struct PairSide {
  const Members::Member* member = nullptr;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double weight = 0.0, greatest = 0.0;
  int vertex = 0;

  void add(const Members::Member& of, int particle, double w) {
    member = &of;
    moment += w * of.body->particles().x.col(particle);
    weight += w;
    if (std::abs(w) <= greatest) return;
    greatest = std::abs(w);
    vertex = particle;
  }
};

/// The point of a pair, whose weights sum to 1, and its place on a surface, to -1. Of two bodies
/// each carries one; of one body the signs tell them apart.
std::pair<PairSide, PairSide> sides_of(const PairContact& pair, const Members& members) {
  const Members::Member& first = members.of(pair.particles[0]);
  PairSide own, other, positive, negative;
  for (std::size_t k = 0; k < pair.count; ++k) {
    const Members::Member& member = members.of(pair.particles[k]);
    const int particle = pair.particles[k] - member.first;
    (&member == &first ? own : other).add(member, particle, pair.weights[k]);
    (pair.weights[k] > 0.0 ? positive : negative).add(member, particle, pair.weights[k]);
  }
  if (other.member == nullptr) return {positive, negative};
  return own.weight > 0.0 ? std::pair(own, other) : std::pair(other, own);
}

void list_of_pairs(const PairContactEffect& pairs, const Members& members,
                   std::vector<TouchedPoint>& touched) {
  for (const PairContact& pair : pairs.contacts()) {
    TouchedPoint touch;
    touch.force = pair.normal_force * pair.normal + pair.friction_force;
    if (touch.force.isZero(0.0)) continue;
    const auto [point, surface] = sides_of(pair, members);
    touch.point = point.moment / point.weight;
    touch.normal = pair.normal;
    touch.body = point.member->number;
    touch.vertex = point.vertex;
    touch.other_body = surface.member->number;
    touched.push_back(touch);
  }
}

Members members_of(const Effect& effect, const Body& body, const World& world) {
  // What is between bodies lies with the first of them and sees the particles of all.
  const bool is_between = effect.name() == "body_contact";
  std::vector<const Body*> bodies = {&body};
  if (is_between) bodies.assign(body.group->bodies().begin(), body.group->bodies().end());
  return Members(bodies, world);
}

}  // namespace

void list_contacts(const World& world, std::vector<TouchedPoint>& touched) {
  touched.clear();
  TouchedPoint touch;
  for (const Body& body : world.bodies()) {
    if (const auto* contact = body.find<ContactEffect>()) {
      list_of_obstacles(*contact, body, touch, touched);
    }
    if (const auto* model = body.model->find<ViscoelasticModel>()) {
      list_of_walls(*model, world.obstacles(), touch, touched);
    }
    for (const auto& effect : body.effects) {
      const auto* pairs = effect->find<PairContactEffect>();
      if (pairs != nullptr) list_of_pairs(*pairs, members_of(*pairs, body, world), touched);
    }
    ++touch.body;
  }
}

const std::string& name_of_other(const TouchedPoint& touched, const World& world) {
  if (touched.obstacle < 0) {
    return world.bodies()[static_cast<std::size_t>(touched.other_body)].name;
  }
  const Obstacle& obstacle = world.obstacles()[static_cast<std::size_t>(touched.obstacle)];
  return obstacle.link.empty() ? obstacle.name : obstacle.link;
}

}  // namespace pliant
