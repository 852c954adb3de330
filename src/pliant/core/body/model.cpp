#include "pliant/core/body/model.h"

namespace pliant {

void Model::place(const Eigen::Isometry3d& world_from_body) {
  Particles& moved = particles();
  moved.x = (world_from_body.linear() * moved.x).colwise() + world_from_body.translation();
  moved.x_start = moved.x;
  moved.history.dt = 0.0;
}

void Model::set_velocity(const Eigen::Vector3d& velocity) {
  Particles& moved = particles();
  for (int i = 0; i < moved.size(); ++i) {
    if (!moved.is_fixed(i)) moved.v.col(i) = velocity;
  }
  moved.v_start = moved.v;
  moved.history.dt = 0.0;
}

int Model::surface_vertices() const {
  const EmbeddedPoints* embedded = surface_points();
  return embedded ? embedded->size() : particles().size();
}

void Model::surface_positions(Eigen::Ref<Eigen::Matrix3Xd> positions) const {
  if (seen_surface_ != nullptr) {
    positions = *seen_surface_;
  } else if (const EmbeddedPoints* embedded = surface_points()) {
    embedded->positions(particles().x, positions);
  } else {
    positions = particles().x;
  }
}

Eigen::Matrix3Xf Model::particle_colors() const { return color.replicate(1, particles().size()); }

Eigen::Matrix3Xf Model::surface_colors() const { return color.replicate(1, surface_vertices()); }

TriangleMesh Model::surface() const {
  TriangleMesh mesh{Eigen::Matrix3Xd(3, surface_vertices()), surface_triangles()};
  surface_positions(mesh.vertices);
  return mesh;
}

Eigen::VectorXd Model::on_surface(const Eigen::VectorXd& field) const {
  const EmbeddedPoints* embedded = surface_points();
  return embedded ? embedded->interpolate(field) : field;
}

}  // namespace pliant
