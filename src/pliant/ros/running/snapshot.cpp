#include "pliant/ros/running/snapshot.h"

#include <algorithm>

#include "pliant/effects/attachment.h"
#include "pliant/effects/contact/contact.h"
#include "pliant/ros/markers/color_by.h"

namespace pliant {
namespace {

void take_forces(World& world, Snapshot& snapshot) {
  snapshot.forces.clear();
  for (const AppliedForces::Active& active : world.applied_forces().active()) {
    if (!active.started || active.mass == 0.0) continue;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (std::size_t b = 0; b < active.points.size(); ++b) {
      const ForcePoints points = world.bodies()[b].force_points();
      for (const int i : active.points[b]) moment += points.mass(i) * points.position(i);
    }
    snapshot.forces.push_back({moment / active.mass, active.request.force});
  }
}

void take_obstacles(const World& world, Snapshot& snapshot) {
  snapshot.obstacle_poses.clear();
  for (const Obstacle& obstacle : world.obstacles()) {
    snapshot.obstacle_poses.push_back(obstacle.pose_end);
  }
}

void take_marks(World& world, Snapshot& snapshot) {
  snapshot.fixed.clear();
  snapshot.held.clear();
  snapshot.contacts.clear();
  for (const Body& body : world.bodies()) {
    const Particles& particles = body.particles();
    for (int i = 0; i < particles.size(); ++i) {
      if (particles.is_fixed(i)) snapshot.fixed.push_back(particles.x.col(i));
    }
    if (const AttachmentEffect* attachments = find_attachments(body)) {
      attachments->add_held(snapshot.held);
    }
    const ContactEffect* effect = body.find<ContactEffect>();
    if (effect == nullptr) continue;
    for (const Contact& contact : effect->contacts()) {
      if (contact.normal_force > 0.0) {
        snapshot.contacts.push_back(effect->points().position(particles.x, contact.point));
      }
    }
  }
  take_forces(world, snapshot);
}

}  // namespace

bool can_be_wet(const Body& body) { return body.model->point_fields().count("wetness") > 0; }

void BodySnapshot::take_surface(const Body& body) {
  const Model& model = *body.model;
  surface.resize(3, model.surface_vertices());
  model.surface_positions(surface);
  if (!color_field.empty()) {
    surface_values = model.on_surface(field_to_color(body, color_field));
  } else if (is_wettable) {
    const auto values = model.point_fields();
    const auto wetness = values.find("wetness");
    if (wetness != values.end()) surface_wetness = model.on_surface(wetness->second);
  }
  surface_changes = model.surface_changes();
  if (surface_changes) {
    surface_triangles = model.surface_triangles();
    surface_colors = model.surface_colors();
  }
}

void BodySnapshot::take_points(const Body& body) {
  x = body.particles().x;
  v = body.particles().v;
  fields = body.model->point_fields();
  if (!color_field.empty()) {
    const auto field = fields.find(color_field);
    particle_values = field == fields.end() ? field_to_color(body, color_field) : field->second;
  }
  surface_changes = body.model->surface_changes();
  if (surface_changes) particle_colors = body.model->particle_colors();
}

Snapshot::Snapshot(const World& world, const std::vector<std::string>& color_fields)
    : bodies(world.bodies().size()) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].is_wettable = can_be_wet(world.bodies()[b]);
    if (!color_fields.empty()) bodies[b].color_field = color_fields[b];
  }
}

void Snapshot::clear_contents() {
  contents = 0;
  for (BodySnapshot& body : bodies) body.contents = 0;
}

void Snapshot::take(World& world) {
  time = world.time();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const unsigned asked = bodies[b].contents | contents;
    if (asked & (kSurface | kSurfaces | kMesh | kShadows))
      bodies[b].take_surface(world.bodies()[b]);
    if (asked & kPoints) bodies[b].take_points(world.bodies()[b]);
  }
  if (contents & (kMarkers | kShadows)) take_obstacles(world, *this);
  if (contents & kMarkers) take_marks(world, *this);
  if (contents & kContacts) {
    list_contacts(world, touched);
    step = world.steps();
  }
}

}  // namespace pliant
