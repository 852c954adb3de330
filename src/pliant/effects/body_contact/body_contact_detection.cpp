#include "pliant/effects/body_contact/body_contact_detection.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "pliant/core/body.h"
#include "pliant/core/columns.h"
#include "pliant/core/step/timer.h"
#include "pliant/effects/body_contact/body_containment.h"
#include "pliant/effects/body_contact/body_intersection.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

// Contacts that a thread makes at once.
constexpr int kGrain = 256;
// Of the thickness: how little a contact of rigid bodies may say that others do not.
constexpr double kRedundant = 5e-4;
// At which bodies part that begin nearer than they should be [m/s]: that of a fall by 20 µm, so
// that nobody sees them jump.
constexpr double kOpeningSpeed = 0.02;

Positions vertices_at(const BodySurfaces& surfaces, const Group& group) {
  Positions all(3, 0), vertices;
  for (const Body* body : group.bodies()) {
    const Positions& own = body->particles().x;
    all.conservativeResize(3, all.cols() + own.cols());
    all.rightCols(own.cols()) = own;
  }
  surfaces.positions(all, vertices);
  return vertices;
}

std::string text_of(const Eigen::Vector3d& place) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", place.x(), place.y(), place.z());
}

/// Throws InputError where bodies that touch are not apart: nothing says to which side they belong.
void check_start(const BodySurfaces& surfaces, const Positions& vertices, const Group& group,
                 const BodyPairTable& pairs) {
  const auto name = [&](int body) { return group.bodies()[static_cast<std::size_t>(body)]->name; };
  const auto refuse = [](const std::string& what, const std::string& one,
                         const std::string& other) {
    // Of bodies that are moved as one ("one+other"), a scene names any.
    const auto in_scene = [](const std::string& whole) { return whole.substr(0, whole.find('+')); };
    throw InputError(fmt::format("{}: move them apart, or let them pass by 'except: [[{}, {}]]'",
                                 what, in_scene(one), in_scene(other)));
  };
  if (const auto found = find_intersection(surfaces, vertices, pairs)) {
    const std::string one = name(found->edge_body), other = name(found->triangle_body);
    refuse(fmt::format("bodies '{}' and '{}' pass through each other at the start, at {}", one,
                       other, text_of(found->place)),
           one, other);
  }
  if (const auto found = find_containment(surfaces, vertices, pairs)) {
    const std::string inner = name(found->inner_body), outer = name(found->outer_body);
    const std::string what =
        found->are_all ? fmt::format("body '{}' lies", inner)
        : found->count == 1
            ? fmt::format("a vertex or particle of body '{}' lies", inner)
            : fmt::format("{} vertices or particles of body '{}' lie", found->count, inner);
    refuse(
        fmt::format("{} within body '{}' at the start, at {}", what, outer, text_of(found->place)),
        inner, outer);
  }
}

bool comes_before(const SheetNearPair& a, const SheetNearPair& b) {
  if (a.kind != b.kind) return a.kind < b.kind;
  return std::lexicographical_compare(a.particles, a.particles + 4, b.particles, b.particles + 4);
}

SheetBodies search_bodies(const BodySurfaces& surfaces, const BodyPairTable& pairs) {
  SheetBodies bodies{surfaces.bodies(), surfaces.radius(), surfaces.radius(), pairs};
  for (std::size_t i = 0; i < bodies.half.size(); ++i) {
    if (bodies.radius[i] == 0.0) bodies.half[i] = 0.5 * pairs.most_thickness(bodies.body[i]);
  }
  return bodies;
}

}  // namespace

BodyContactDetection::BodyContactDetection(const Group& group, const BodyPairTable& pairs,
                                           const Options& options)
    : group_(group),
      surfaces_(group),
      search_(vertices_at(surfaces_, group), surfaces_.triangles(), search_bodies(surfaces_, pairs),
              options.margin),
      pairs_(pairs),
      reach_(search_.thickness() + options.margin),
      redundant_(kRedundant * options.thickness) {
  const Positions vertices = vertices_at(surfaces_, group);
  check_start(surfaces_, vertices, group, pairs_);
  find_missing(vertices);
}

void BodyContactDetection::find_missing(const Positions& vertices) {
  const auto count = static_cast<std::size_t>(pairs_.bodies());
  missing_.assign(count * count, 0.0);
  if (surfaces_.are_far_apart(vertices, vertices, reach_, pairs_)) return;
  const SheetNearPairs found = search_.find(vertices, vertices);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto [one, other] = bodies_of(found[k]);
    const double missing = found[k].thickness - found[k].approach.start;
    for (const std::size_t place : {place_of(one, other), place_of(other, one)}) {
      missing_[place] = std::max(missing_[place], missing);
    }
    most_missing_ = std::max(most_missing_, missing);
  }
}

void BodyContactDetection::open(double dt) {
  opened_ = std::min(most_missing_, opened_ + kOpeningSpeed * dt);
}

std::pair<int, int> BodyContactDetection::bodies_of(const SheetNearPair& found) const {
  const auto body = [&](int k) {
    return surfaces_.bodies()[static_cast<std::size_t>(found.particles[k])];
  };
  return {body(0), body(3)};
}

std::pair<int, int> BodyContactDetection::bodies_of(const PairContact& contact) const {
  const auto body = [&](std::size_t k) {
    return surfaces_.bodies()[static_cast<std::size_t>(contact.simplices[k])];
  };
  return {body(1), body(4)};
}

bool BodyContactDetection::is_of_rigid(const PairContact& contact) const {
  const auto [one, other] = bodies_of(contact);
  return surfaces_.is_rigid(one) || surfaces_.is_rigid(other);
}

void BodyContactDetection::find(const Particles& particles, double dt,
                                std::vector<PairContact>& contacts) {
  contacts.clear();
  find_again(particles, dt, contacts);
}

void BodyContactDetection::find_again(const Particles& particles, double dt,
                                      std::vector<PairContact>& contacts) {
  search(particles);
  make_contacts(dt, contacts.size(), contacts);
}

void BodyContactDetection::search(const Particles& particles) {
  const Timer timer;
  from_ = particles.x_start;
  surfaces_.positions(from_, start_);
  surfaces_.positions(particles.x, end_);
  are_far_apart_ = surfaces_.are_far_apart(start_, end_, reach_, pairs_);
  found_ = are_far_apart_ ? SheetNearPairs{} : search_.find(start_, end_);
  search_seconds_ += timer.seconds();
}

bool BodyContactDetection::limit_displacement(const Particles& particles, double dt, Positions& x,
                                              std::vector<PairContact>& contacts) {
  const Timer timer;
  surfaces_.positions(x, end_);
  if (surfaces_.are_far_apart(start_, end_, reach_, pairs_)) return true;
  // Far apart until now, they were not searched.
  if (are_far_apart_) found_ = search_.find(start_, end_);
  are_far_apart_ = false;
  wanted_ = x;
  reached_ = x;
  const auto place = [&](const std::vector<double>& shares, Positions& vertices) {
    go_back(particles, shares, vertices);
  };
  const bool is_free = search_.limit_displacement(place, end_, found_);
  search_seconds_ += timer.seconds();
  if (is_free) return true;
  x = reached_;
  from_ = reached_;
  start_ = end_;
  make_contacts(dt, 0, contacts);
  return false;
}

void BodyContactDetection::go_back(const Particles& particles, const std::vector<double>& shares,
                                   Positions& vertices) {
  particle_shares_.assign(static_cast<std::size_t>(particles.size()), 1.0);
  for (int i = 0; i < surfaces_.size(); ++i) {
    for (const auto* entry = surfaces_.begin(i); entry != surfaces_.end(i); ++entry) {
      double& share = particle_shares_[static_cast<std::size_t>(entry->particle)];
      share = std::min(share, shares[static_cast<std::size_t>(i)]);
    }
  }
  // What follows coordinates goes a share of its displacement as a whole.
  const auto& responders = group_.joint()->responders;
  for (const auto& responder : responders) {
    const auto begin = particle_shares_.begin() + responder.begin,
               end = particle_shares_.begin() + responder.end;
    std::fill(begin, end, *std::min_element(begin, end));
  }
  const auto follows = [&](int i) {
    return std::any_of(responders.begin(), responders.end(),
                       [&](const auto& responder) { return responder.has(i); });
  };
  for_each_column(reached_, [&](int i) {
    const double share = particle_shares_[static_cast<std::size_t>(i)];
    if (particles.is_fixed(i) && !follows(i)) return;
    reached_.col(i) = from_.col(i) + share * (wanted_.col(i) - from_.col(i));
  });
  group_.joint()->keep_rigid(reached_);
  surfaces_.positions(reached_, vertices);
}

void BodyContactDetection::make_contacts(double dt, std::size_t kept,
                                         std::vector<PairContact>& contacts) {
  order_.resize(found_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(),
            [this](std::size_t a, std::size_t b) { return comes_before(found_[a], found_[b]); });
  contacts.resize(kept + found_.size());
  parallel_for(0, static_cast<int>(found_.size()), kGrain, [&](int begin, int end) {
    for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
      contacts[kept + k] = contact(found_[order_[k]], dt);
    }
  });
  leave_out_redundant(kept, contacts);
}

void BodyContactDetection::leave_out_redundant(std::size_t kept,
                                               std::vector<PairContact>& contacts) {
  redundant_.clear();
  rigid_.clear();
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const auto [one, other] = bodies_of(found_[order_[k]]);
    if (!surfaces_.is_rigid(one) || !surfaces_.is_rigid(other)) continue;
    contacts[kept + k].is_rigid = true;
    rigid_.push_back(kept + k);
    redundant_.add(place_of(found_[order_[k]], contacts[kept + k]));
  }
  if (rigid_.empty()) return;
  const std::vector<char>& is_redundant = redundant_.find();
  std::size_t next = 0, end = kept;
  for (std::size_t c = kept; c < contacts.size(); ++c) {
    const bool is_rigid = next < rigid_.size() && rigid_[next] == c;
    if (is_rigid && is_redundant[next++]) continue;
    contacts[end++] = contacts[c];
  }
  contacts.resize(end);
}

RedundantContacts::Place BodyContactDetection::place_of(const SheetNearPair& found,
                                                        const PairContact& contact) const {
  const auto [one, other] = bodies_of(found);
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), apart = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) {
    const double weight = found.approach.weights.of[k];
    const Eigen::Vector3d vertex = end_.col(found.particles[k]);
    apart += weight * vertex;
    position += std::max(0.0, weight) * vertex;
  }
  const double gap = contact.normal.dot(apart) - contact.least;
  // Of two faces either one's vertices may be what was found.
  const double sign = one < other ? 1.0 : -1.0;
  return {std::min(one, other) * pairs_.bodies() + std::max(one, other), sign * contact.normal,
          position, gap};
}

Eigen::Vector3d BodyContactDetection::direction_out(const SheetNearPair& found) const {
  const auto at = [&](int k) { return Eigen::Vector3d(start_.col(found.particles[k])); };
  if (!found.is_vertex()) return (at(1) - at(0)).cross(at(3) - at(2));
  return (at(2) - at(1)).cross(at(3) - at(1));
}

PairContact BodyContactDetection::contact(const SheetNearPair& found, double dt) const {
  PairContact contact;
  const Double3& between = found.approach.between;
  const Eigen::Vector3d apart(between.x, between.y, between.z);
  const bool is_apart = apart.norm() > sheet_pairs::kTouching * found.thickness;
  contact.normal = (is_apart ? apart : direction_out(found)).stableNormalized();
  if (contact.normal.isZero(0.0)) contact.normal = Eigen::Vector3d::UnitZ();
  contact.count = 0;
  contact.simplices[0] = static_cast<int>(found.kind);
  std::copy(found.particles, found.particles + 4, contact.simplices.begin() + 1);
  for (int k = 0; k < 4; ++k) {
    const double weight = found.approach.weights.of[k];
    if (weight == 0.0) continue;
    const int vertex = found.particles[k];
    for (const auto* entry = surfaces_.begin(vertex); entry != surfaces_.end(vertex); ++entry) {
      const auto end = contact.particles.begin() + static_cast<std::ptrdiff_t>(contact.count);
      const auto known = std::find(contact.particles.begin(), end, entry->particle);
      const auto place = static_cast<std::size_t>(known - contact.particles.begin());
      if (known == end) {
        contact.particles[place] = entry->particle;
        contact.weights[place] = 0.0;
        ++contact.count;
      }
      contact.weights[place] += weight * entry->weight;
    }
  }
  const auto [one, other] = bodies_of(found);
  contact.friction = pairs_(one, other).friction;
  contact.start = contact.relative(from_);
  contact.least = found.thickness - std::max(0.0, missing_[place_of(one, other)] - opened_);
  if (found.approach.time == 0.0) {
    const double gap = contact.normal.dot(contact.start);
    contact.least = std::min(contact.least, gap + kMaxPushOutSpeed * dt);
  }
  return contact;
}

}  // namespace pliant
