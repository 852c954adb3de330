#include "pliant/effects/contact/pinching.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace pliant {
namespace {

// Surfaces whose normals enclose more than 120 degrees press against each other.
constexpr double kOpposite = -0.5;
// Of the offset: the room that is missing where the obstacles' own surfaces meet, or the body's
// with both, is twice that.
constexpr double kTold = 1.9;
// Of the offset: a contact that is open by less is closed.
constexpr double kClosed = 0.01;
// How many times as bad it has to be to be told anew.
constexpr double kWorse = 2.0;

}  // namespace

void Pinching::list(const ContactPoints& points, const Positions& x,
                    const std::vector<Contact>& contacts) {
  closed_.clear();
  for (const Contact& contact : contacts) {
    const double gap = contact.normal.dot(points.position(x, contact.point)) - contact.plane;
    // What one obstacle holds wholly may lie within the other.
    if (!(gap < kClosed * offset_)) continue;
    closed_.push_back({contact.point, contact.obstacle, std::max(0.0, -gap), contact.normal});
  }
}

void Pinching::take(const Closed& a, const Closed& b, Found& found) const {
  if (a.obstacle == b.obstacle || a.normal.dot(b.normal) > kOpposite) return;
  const double missing = a.missing + b.missing;
  if (!(missing > kTold * offset_)) return;
  ++found.points;
  if (missing <= found.missing) return;
  found.one = std::min(a.obstacle, b.obstacle);
  found.other = std::max(a.obstacle, b.obstacle);
  found.missing = missing;
  found.point = a.missing > b.missing ? a.point : b.point;
}

Pinching::Found Pinching::worst_vertex() {
  // Not a stable sort, which takes memory.
  std::sort(closed_.begin(), closed_.end(), [](const Closed& a, const Closed& b) {
    return std::tie(a.point, a.obstacle, a.missing) < std::tie(b.point, b.obstacle, b.missing);
  });
  Found found;
  for (std::size_t k = 1; k < closed_.size(); ++k) {
    if (closed_[k].point == closed_[k - 1].point) take(closed_[k - 1], closed_[k], found);
  }
  return found;
}

Pinching::Found Pinching::worst_of_body() {
  // Of each obstacle the deepest, of which there are few.
  deepest_.clear();
  for (const Closed& closed : closed_) {
    const auto same = std::find_if(deepest_.begin(), deepest_.end(), [&](const Closed& other) {
      return other.obstacle == closed.obstacle;
    });
    if (same == deepest_.end()) {
      deepest_.push_back(closed);
    } else if (closed.missing > same->missing) {
      *same = closed;
    }
  }
  Found found;
  for (std::size_t a = 0; a < deepest_.size(); ++a) {
    for (std::size_t b = a + 1; b < deepest_.size(); ++b) take(deepest_[a], deepest_[b], found);
  }
  return found;
}

void Pinching::look(const ContactPoints& points, const Positions& x,
                    const std::vector<Contact>& contacts, const std::vector<Obstacle>& obstacles) {
  told_before_ = told_;
  was_pinched_ = is_pinched_;
  list(points, x, contacts);
  const bool is_solid = points.are_embedded();
  const Found found = is_solid ? worst_of_body() : worst_vertex();
  is_pinched_ = found.points > 0;
  if (!is_pinched_) return;
  const bool is_told = found.one == told_.one && found.other == told_.other &&
                       found.missing < kWorse * told_.missing;
  if (is_told) return;
  told_ = found;
  const auto name = [&](int o) { return obstacles[static_cast<std::size_t>(o)].name; };
  const auto is_link = [&](int o) { return !obstacles[static_cast<std::size_t>(o)].link.empty(); };
  const char* const cure = is_link(found.one) || is_link(found.other)
                               ? ", or let the robot's joints stall (`effort: limit`)"
                               : "";
  const Eigen::Vector3d place = points.position(x, found.point);
  const std::string where =
      is_solid ? fmt::format("at ({:.3g}, {:.3g}, {:.3g}) m", place.x(), place.y(), place.z())
      : found.points == 1
          ? fmt::format("at vertex {}", found.point)
          : fmt::format("at {} vertices, the most at {}", found.points, found.point);
  text_ = fmt::format(
      "pinched: '{}' and '{}' come {:.1g} mm closer than what is between them lets them, {}: keep "
      "them farther apart, or take a softer or thinner body or a smaller `thickness` of contact{}",
      name(found.one), name(found.other), 1e3 * found.missing, where, cure);
}

void Pinching::undo() {
  told_ = told_before_;
  is_pinched_ = was_pinched_;
}

void Pinching::reset() {
  told_before_ = Found();
  was_pinched_ = false;
  told_ = Found();
  is_pinched_ = false;
}

}  // namespace pliant
