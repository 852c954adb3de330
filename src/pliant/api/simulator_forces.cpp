// What acts on the bodies of a Simulator, and what they answer.
#include <fmt/format.h>

#include "pliant/api/simulator_data.h"
#include "pliant/core/world.h"
#include "pliant/effects/attachment.h"
#include "pliant/scene/contact_list.h"
#include "pliant/scene/robot/wrenches.h"

namespace pliant {

void Simulator::apply_force(const std::string& body, const Eigen::Vector3d& point, double radius,
                            const Eigen::Vector3d& force, double duration) {
  data_->world().applied_forces().add(
      {point, radius, force, time(), duration, data_->index_of(body)});
}

void Simulator::clear_forces() { data_->world().applied_forces().clear(); }

int Simulator::attach(const std::string& body, const std::string& name,
                      const Eigen::Vector3d& point, double radius, const std::string& holder,
                      double stiffness) {
  World& world = data_->world();
  Body& held = world.bodies()[static_cast<std::size_t>(data_->index_of(body))];
  if (name.empty()) throw InputError("attach: 'name' is empty");
  if (!point.allFinite() || !(radius >= 0.0)) {
    throw InputError(fmt::format(
        "attach: 'point' must be finite and 'radius' >= 0 m, but they are ({:g}, {:g}, {:g}) m and "
        "{:g} m",
        point.x(), point.y(), point.z(), radius));
  }
  AttachmentRequest request;
  request.name = name;
  request.region.kind = Region::Kind::kSphere;
  request.region.center = point;
  request.region.radius = radius;
  request.count = held.particles().size();
  request.obstacle = find_holder(holder, world.obstacles());
  request.stiffness = stiffness;
  return attachments_of(held, world.obstacles()).attach_now(request, world.time_step());
}

void Simulator::detach(const std::string& body, const std::string& name) {
  World& world = data_->world();
  Body& held = world.bodies()[static_cast<std::size_t>(data_->index_of(body))];
  if (find_attachments(held) == nullptr) {
    throw InputError("detach: nothing holds body '" + body + "'");
  }
  attachments_of(held, world.obstacles()).detach(name, world.time_step());
}

std::vector<std::string> Simulator::attachments(const std::string& body) const {
  const AttachmentEffect* effect = find_attachments(data_->body(body));
  return effect == nullptr ? std::vector<std::string>() : effect->names();
}

std::vector<Simulator::Contact> Simulator::contacts() const {
  std::vector<TouchedPoint> touched;
  list_contacts(data_->world(), touched);
  std::vector<Contact> contacts;
  for (const TouchedPoint& point : touched) {
    contacts.push_back({data_->world().bodies()[static_cast<std::size_t>(point.body)].name,
                        point.vertex, name_of_other(point, data_->world()), point.point,
                        point.normal, point.force});
  }
  return contacts;
}

std::vector<Simulator::Wrench> Simulator::wrenches() const {
  WrenchAverage step(data_->world().obstacles());
  step.add(data_->world().obstacles(), data_->world().reactions());
  std::vector<Wrench> wrenches;
  for (const pliant::Wrench& wrench : step.take()) {
    wrenches.push_back({wrench.name, wrench.is_robot_link, wrench.force, wrench.torque});
  }
  return wrenches;
}

}  // namespace pliant
