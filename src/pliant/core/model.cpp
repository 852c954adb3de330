#include "pliant/core/model.h"

namespace pliant {

int Model::surface_vertices() const {
  const CarriedPoints* carried = surface_points();
  return carried ? carried->size() : particles().size();
}

void Model::surface_positions(Eigen::Ref<Eigen::Matrix3Xd> positions) const {
  if (const CarriedPoints* carried = surface_points()) {
    carried->positions(particles().x, positions);
  } else {
    positions = particles().x;
  }
}

TriangleMesh Model::surface() const {
  TriangleMesh mesh{Eigen::Matrix3Xd(3, surface_vertices()), surface_triangles()};
  surface_positions(mesh.vertices);
  return mesh;
}

Eigen::VectorXd Model::on_surface(const Eigen::VectorXd& field) const {
  const CarriedPoints* carried = surface_points();
  return carried ? carried->interpolate(field) : field;
}

}  // namespace pliant
