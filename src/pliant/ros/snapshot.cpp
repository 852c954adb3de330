#include "pliant/ros/snapshot.h"

#include <algorithm>

#include "pliant/effects/attachment.h"
#include "pliant/effects/contact.h"

namespace pliant {
namespace {

int vertex_count(const World& world) {
  int count = 0;
  for (const Body& body : world.bodies()) count += body.particles().size();
  return count;
}

void take_vertices(const World& world, Snapshot& snapshot) {
  const int count = vertex_count(world);
  snapshot.x.resize(3, count);
  snapshot.v.resize(3, count);
  int first = 0;
  for (const Body& body : world.bodies()) {
    const Particles& particles = body.particles();
    snapshot.x.middleCols(first, particles.size()) = particles.x;
    snapshot.v.middleCols(first, particles.size()) = particles.v;
    first += particles.size();
  }
}

void take_surface(const World& world, bool can_be_wet, Snapshot& snapshot) {
  int count = 0;
  for (const Body& body : world.bodies()) count += body.model->surface_vertices();
  snapshot.surface.resize(3, count);
  snapshot.surface_wetness = Eigen::VectorXd::Zero(can_be_wet ? count : 0);
  int first = 0;
  for (const Body& body : world.bodies()) {
    const int own = body.model->surface_vertices();
    body.model->surface_positions(snapshot.surface.middleCols(first, own));
    if (can_be_wet) {
      const auto fields = body.model->point_fields();
      const auto wetness = fields.find("wetness");
      if (wetness != fields.end()) {
        snapshot.surface_wetness.segment(first, own) = body.model->on_surface(wetness->second);
      }
    }
    first += own;
  }
}

bool any_surface_changes(const World& world) {
  return std::any_of(world.bodies().begin(), world.bodies().end(),
                     [](const Body& body) { return body.model->surface_changes(); });
}

/// The triangles and colours of surfaces that are made anew for each state.
void take_changing_surface(const World& world, Snapshot& snapshot) {
  Eigen::Index count = 0, first = 0, first_vertex = 0;
  for (const Body& body : world.bodies()) count += body.model->surface_triangles().cols();
  snapshot.surface_triangles.resize(3, count);
  snapshot.surface_colors.resize(3, snapshot.surface.cols());
  for (const Body& body : world.bodies()) {
    const Eigen::Matrix3Xi& own = body.model->surface_triangles();
    const Eigen::Index vertices = body.model->surface_vertices();
    snapshot.surface_triangles.middleCols(first, own.cols()) =
        own.array() + static_cast<int>(first_vertex);
    snapshot.surface_colors.middleCols(first_vertex, vertices) = body.model->surface_colors();
    first += own.cols();
    first_vertex += vertices;
  }
}

void take_changing_colors(const World& world, Snapshot& snapshot) {
  snapshot.particle_colors.resize(3, snapshot.x.cols());
  Eigen::Index first = 0;
  for (const Body& body : world.bodies()) {
    snapshot.particle_colors.middleCols(first, body.particles().size()) =
        body.model->particle_colors();
    first += body.particles().size();
  }
}

void take_fields(const World& world, Snapshot& snapshot) {
  const int count = vertex_count(world);
  snapshot.fields.clear();
  int first = 0;
  for (const Body& body : world.bodies()) {
    for (const auto& [name, values] : body.model->point_fields()) {
      // A body without the field shows 0.
      auto& all = snapshot.fields.try_emplace(name, Eigen::VectorXd::Zero(count)).first->second;
      all.segment(first, values.size()) = values;
    }
    first += body.particles().size();
  }
}

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

void take_marks(World& world, Snapshot& snapshot) {
  snapshot.obstacle_poses.clear();
  for (const Obstacle& obstacle : world.obstacles()) {
    snapshot.obstacle_poses.push_back(obstacle.pose_end);
  }
  snapshot.fixed.clear();
  snapshot.held.clear();
  snapshot.contacts.clear();
  for (const Body& body : world.bodies()) {
    const Particles& particles = body.particles();
    for (int i = 0; i < particles.size(); ++i) {
      if (particles.is_fixed(i)) snapshot.fixed.push_back(particles.x.col(i));
    }
    if (const Effect* attachments = body.find_effect("attachment")) {
      dynamic_cast<const AttachmentEffect&>(*attachments).add_held(snapshot.held);
    }
    const auto* effect = dynamic_cast<const ContactEffect*>(body.find_effect("contact"));
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

void Snapshot::take(World& world, bool can_be_wet) {
  surface_changes = any_surface_changes(world);
  if (contents & kSurface) {
    take_surface(world, can_be_wet, *this);
    if (surface_changes) take_changing_surface(world, *this);
  }
  if (contents & kPoints) {
    take_vertices(world, *this);
    take_fields(world, *this);
    if (surface_changes) take_changing_colors(world, *this);
  }
  if (contents & kMarkers) take_marks(world, *this);
}

}  // namespace pliant
