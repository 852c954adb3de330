#include "pliant/ros/surface_marker.h"

#include "pliant/core/wettable.h"
#include "pliant/ros/conversions.h"

namespace pliant {
namespace {

constexpr float kAmbient = 0.35f;
constexpr float kDiffuse = 0.65f;
// From above and the side, so that both level and upright folds show.
const Eigen::Vector3d kLight = Eigen::Vector3d(0.4, -0.3, 0.87).normalized();

/// Brightness of each vertex. Of a sheet both sides are lit alike; a solid is dark where it turns
/// away, softly, since there is but one light.
Eigen::VectorXf shading(const TriangleMesh& mesh, bool is_solid) {
  Eigen::ArrayXf cosines =
      (kLight.transpose() * vertex_normals(mesh)).transpose().cast<float>().array();
  cosines = is_solid ? Eigen::ArrayXf(0.5f + 0.5f * cosines) : Eigen::ArrayXf(cosines.abs());
  return kAmbient + kDiffuse * cosines;
}

void make_room(const TriangleMesh& mesh, visualization_msgs::Marker& marker) {
  const auto points = static_cast<std::size_t>(mesh.triangles.size());
  marker.points.resize(points);
  marker.colors.resize(points);
}

}  // namespace

VertexColors::VertexColors(const Body& body, Of of) {
  const Model& model = *body.model;
  if (dynamic_cast<const Wettable*>(&model) != nullptr) {
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

SurfaceMarker::SurfaceMarker(const Body& body)
    : colors_(body, VertexColors::Of::kSurface),
      mesh_{Eigen::Matrix3Xd(3, body.model->surface_vertices()), body.model->surface_triangles()},
      // Particles' surfaces are closed, and so are those that are carried, as a rigid body's.
      is_solid_(body.model->tetrahedra() != nullptr || body.model->surface_points() != nullptr ||
                body.model->surface_changes()) {}

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
      snapshot.surface_changes ? snapshot.surface_colors : colors_.update(snapshot.surface_wetness);
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
