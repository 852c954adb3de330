#include "pliant/ros/markers/contact_messages.h"

#include "pliant/ros/conversions.h"

namespace pliant {

ContactMessages::ContactMessages(const World& world, const BodyNames& names) {
  for (const Obstacle& obstacle : world.obstacles()) {
    const bool is_link = !obstacle.link.empty();
    const std::uint8_t kind = is_link ? Contacts::LINK : Contacts::OBSTACLE;
    obstacles_.push_back({is_link ? obstacle.link : obstacle.name, kind});
  }
  for (std::size_t b = 0; b < names.size(); ++b) bodies_.push_back(names.name(b));
}

const Contacts& ContactMessages::update(const std::vector<TouchedPoint>& touched,
                                        std::uint64_t step) {
  message_.step = step;
  message_.points.clear();
  message_.normals.clear();
  message_.forces.clear();
  message_.bodies.clear();
  message_.vertices.clear();
  message_.others.clear();
  message_.kinds.clear();
  for (const TouchedPoint& touch : touched) {
    const bool by_body = touch.obstacle < 0;
    const Other other =
        by_body ? Other{bodies_.at(static_cast<std::size_t>(touch.other_body)), Contacts::BODY}
                : obstacles_.at(static_cast<std::size_t>(touch.obstacle));
    message_.points.push_back(to_point(touch.point));
    message_.normals.push_back(to_vector3(touch.normal));
    message_.forces.push_back(to_vector3(touch.force));
    message_.bodies.push_back(bodies_.at(static_cast<std::size_t>(touch.body)));
    message_.vertices.push_back(touch.vertex);
    message_.others.push_back(other.name);
    message_.kinds.push_back(other.kind);
  }
  return message_;
}

}  // namespace pliant
