#include "pliant/ros/surface_marker.h"

#include "pliant/core/wettable.h"
#include "pliant/ros/conversions.h"

namespace pliant {
namespace {

constexpr float kAmbient = 0.35f;
constexpr float kDiffuse = 0.65f;
// From above and the side, so that both level and upright folds show.
const Eigen::Vector3d kLight = Eigen::Vector3d(0.4, -0.3, 0.87).normalized();

TriangleMesh all_surfaces(const World& world) {
  Eigen::Index vertices = 0;
  Eigen::Index triangles = 0;
  for (const Body& body : world.bodies()) {
    vertices += body.model->surface_vertices();
    triangles += body.model->surface_triangles().cols();
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, vertices);
  mesh.triangles.resize(3, triangles);
  vertices = triangles = 0;
  for (const Body& body : world.bodies()) {
    const Eigen::Matrix3Xi& own = body.model->surface_triangles();
    mesh.triangles.middleCols(triangles, own.cols()) = own.array() + static_cast<int>(vertices);
    vertices += body.model->surface_vertices();
    triangles += own.cols();
  }
  return mesh;
}

/// Brightness of each vertex. Of a sheet both sides are lit alike; a solid is dark where it turns
/// away, softly, since there is but one light.
Eigen::VectorXf shading(const TriangleMesh& mesh,
                        const Eigen::Array<bool, Eigen::Dynamic, 1>& solid) {
  const Eigen::ArrayXf cosines =
      (kLight.transpose() * vertex_normals(mesh)).transpose().cast<float>().array();
  return kAmbient + kDiffuse * solid.select(0.5f + 0.5f * cosines, cosines.abs());
}

Eigen::Array<bool, Eigen::Dynamic, 1> solid_vertices(const World& world) {
  Eigen::Array<bool, Eigen::Dynamic, 1> solid(0);
  for (const Body& body : world.bodies()) {
    const Eigen::Index first = solid.size();
    solid.conservativeResize(first + body.model->surface_vertices());
    solid.tail(solid.size() - first) = body.model->tetrahedra() != nullptr;
  }
  return solid;
}

}  // namespace

VertexColors::VertexColors(const World& world, Of of) {
  const auto size = [of](const Body& body) {
    return of == Of::kParticles ? body.particles().size() : body.model->surface_vertices();
  };
  Eigen::Index count = 0;
  for (const Body& body : world.bodies()) count += size(body);
  dry_.resize(3, count);
  Eigen::Index first = 0;
  for (const Body& body : world.bodies()) {
    auto own = dry_.middleCols(first, size(body));
    if (dynamic_cast<const Wettable*>(body.model.get()) != nullptr) {
      // Its own colours are those of its water now.
      own.colwise() = body.model->color;
    } else {
      own = of == Of::kParticles ? body.model->particle_colors() : body.model->surface_colors();
    }
    first += size(body);
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

SurfaceMarker::SurfaceMarker(const World& world, const std::string& frame)
    : colors_(world, VertexColors::Of::kSurface),
      mesh_(all_surfaces(world)),
      solid_(solid_vertices(world)) {
  marker_.header.frame_id = frame;
  marker_.ns = "surface";
  marker_.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker_.action = visualization_msgs::Marker::ADD;
  marker_.pose.orientation.w = 1.0;
  marker_.scale.x = marker_.scale.y = marker_.scale.z = 1.0;
  marker_.color = to_color(Eigen::Vector3f(1.0f, 1.0f, 1.0f));
  make_room();
}

void SurfaceMarker::make_room() {
  const auto points = static_cast<std::size_t>(mesh_.triangles.size());
  marker_.points.resize(points);
  marker_.colors.resize(points);
}

const visualization_msgs::Marker& SurfaceMarker::update(const Snapshot& snapshot) {
  if (snapshot.surface_changes) {
    mesh_.triangles = snapshot.surface_triangles;
    make_room();
    // Particles' surfaces are closed; a sheet beside them is shaded like one.
    solid_.setConstant(snapshot.surface.cols(), true);
  }
  const Eigen::Matrix3Xf& colors =
      snapshot.surface_changes ? snapshot.surface_colors : colors_.update(snapshot.surface_wetness);
  marker_.header = snapshot.header;
  mesh_.vertices = snapshot.surface;
  const Eigen::VectorXf brightness = shading(mesh_, solid_);
  const int* corner = mesh_.triangles.data();
  for (std::size_t k = 0; k < marker_.points.size(); ++k) {
    const int i = corner[k];
    geometry_msgs::Point& point = marker_.points[k];
    point.x = snapshot.surface(0, i);
    point.y = snapshot.surface(1, i);
    point.z = snapshot.surface(2, i);
    std_msgs::ColorRGBA& color = marker_.colors[k];
    color.r = brightness[i] * colors(0, i);
    color.g = brightness[i] * colors(1, i);
    color.b = brightness[i] * colors(2, i);
    color.a = 1.0f;
  }
  return marker_;
}

}  // namespace pliant
