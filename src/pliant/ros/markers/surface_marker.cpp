#include "pliant/ros/markers/surface_marker.h"

#include "pliant/core/body/wettable.h"
#include "pliant/ros/conversions.h"
#include "pliant/ros/markers/shading.h"

namespace pliant {
namespace {

/// Brightness of each vertex.
Eigen::VectorXf shading(const TriangleMesh& mesh, bool is_solid) {
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  Eigen::VectorXf brightness(normals.cols());
  for (Eigen::Index i = 0; i < normals.cols(); ++i) {
    brightness[i] = is_solid ? solid_brightness(normals.col(i)) : sheet_brightness(normals.col(i));
  }
  return brightness;
}

void make_room(const TriangleMesh& mesh, visualization_msgs::Marker& marker) {
  const auto points = static_cast<std::size_t>(mesh.triangles.size());
  marker.points.resize(points);
  marker.colors.resize(points);
}

}  // namespace

VertexColors::VertexColors(const Body& body, Of of) {
  const Model& model = *body.model;
  if (model.find<Wettable>() != nullptr) {
    // Its own colours are those of its water now.
    const int count = of == Of::kParticles ? body.particles().size() : model.surface_vertices();
    dry_ = model.color.replicate(1, count);
  } else {
    dry_ = of == Of::kParticles ? model.particle_colors() : model.surface_colors();
  }
  colors_ = dry_;
}

const Eigen::Matrix3Xf& VertexColors::update(const Eigen::VectorXd& wetness) {
  if (wetness.size() > 0) {
    const Eigen::ArrayXf share = wetness.cast<float>().array().max(0.0f).min(1.0f);
    const Eigen::ArrayXf brightness = 1.0f - (1.0f - kWetBrightness) * share;
    colors_ = dry_.array().rowwise() * brightness.transpose();
  }
  return colors_;
}

bool is_drawn_solid(const Model& model) {
  return model.tetrahedra() != nullptr || model.surface_points() != nullptr ||
         model.surface_changes();
}

SurfaceMarker::SurfaceMarker(const Body& body)
    : colors_(body, VertexColors::Of::kSurface),
      mesh_{Eigen::Matrix3Xd(3, body.model->surface_vertices()), body.model->surface_triangles()},
      is_solid_(is_drawn_solid(*body.model)) {}

visualization_msgs::Marker SurfaceMarker::first(const std::string& frame,
                                                const std::string& space) const {
  visualization_msgs::Marker marker;
  marker.header.frame_id = frame;
  marker.ns = space;
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = to_color(Eigen::Vector3f(1.0f, 1.0f, 1.0f));
  make_room(mesh_, marker);
  return marker;
}

void SurfaceMarker::update(const BodySnapshot& snapshot, const std_msgs::Header& header,
                           visualization_msgs::Marker& marker) {
  if (snapshot.surface_changes) {
    mesh_.triangles = snapshot.surface_triangles;
    make_room(mesh_, marker);
  }
  const Eigen::Matrix3Xf& colors =
      snapshot.has_colors() ? snapshot.surface_colors : colors_.update(snapshot.surface_wetness);
  marker.header = header;
  mesh_.vertices = snapshot.surface;
  const Eigen::VectorXf brightness = shading(mesh_, is_solid_);
  const int* corner = mesh_.triangles.data();
  for (std::size_t k = 0; k < marker.points.size(); ++k) {
    const int i = corner[k];
    geometry_msgs::Point& point = marker.points[k];
    point.x = snapshot.surface(0, i);
    point.y = snapshot.surface(1, i);
    point.z = snapshot.surface(2, i);
    std_msgs::ColorRGBA& color = marker.colors[k];
    color.r = brightness[i] * colors(0, i);
    color.g = brightness[i] * colors(1, i);
    color.b = brightness[i] * colors(2, i);
    color.a = 1.0f;
  }
}

}  // namespace pliant
