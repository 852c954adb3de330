#include "pliant/study/experiments/figure_scene.h"

#include <cmath>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/mesh/volume_moments.h"
#include "pliant/models/viscoelastic/interior_samples.h"

namespace pliant {

BodyGeometry filled_figure(const std::string& file, double particles) {
  const TriangleMesh surface = read_triangle_mesh(file);
  const InteriorSamples samples =
      sample_interior(surface, std::cbrt(std::abs(signed_volume(surface)) / particles));
  BodyGeometry geometry;
  geometry.interior_points = samples.points;
  geometry.volume = samples.volume;
  return geometry;
}

double figure_spacing(const BodyGeometry& figure) {
  return std::cbrt(figure.volume / static_cast<double>(figure.interior_points.cols()));
}

void bend_figure(ParticleScene& scene, double spacing) {
  scene.fix_below(2, scene.particles().x.row(2).minCoeff() + 2.0 * spacing);
  scene.add_effect("gravity", {{"acceleration", "[6, 0, -7.76]"}});
  scene.add_effect("damping", {{"rate", "10"}});
}

}  // namespace pliant
