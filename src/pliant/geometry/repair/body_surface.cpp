#include "pliant/geometry/repair/body_surface.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "pliant/geometry/distance/mesh_shape.h"
#include "pliant/geometry/mesh/mesh_faults.h"
#include "pliant/geometry/meshing/simplify.h"
#include "pliant/geometry/repair/isosurface.h"
#include "pliant/geometry/repair/solid_samples.h"
#include "pliant/geometry/repair/sound_mesh.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr double kSamples = 96.0;  // along the longest side
constexpr double kNear = 3.0;  // spacings: the new surface passes between samples that are nearer
constexpr int kTriangles = 20'000;

}  // namespace

TriangleMesh make_body_surface(const TriangleMesh& mesh, std::string& note, bool keep_holes) {
  SoundMesh sound = make_sound(mesh);
  std::vector<std::string> parts = sound.faults;
  const bool is_closed = sound.closed || (keep_holes && sound.is_manifold);
  const bool as_it_is = is_closed && !sound.overlaps && mesh_faults(sound.mesh).empty();
  if (!as_it_is) {
    const Eigen::AlignedBox3d bounds(sound.mesh.vertices.rowwise().minCoeff(),
                                     sound.mesh.vertices.rowwise().maxCoeff());
    DistanceGrid grid = lay_grid(bounds, bounds.sizes().maxCoeff() / kSamples);
    const SolidSamples found = sample_solid(sound.mesh, grid, kNear * grid.spacing);
    for (const std::string& phrase : found.phrases()) parts.push_back(phrase);
    if (!found.is_plausible()) {
      throw InputError(
          fmt::format("it bounds no solid that a body could fill: {}", fmt::join(parts, ", ")));
    }
    sound.mesh = simplify(isosurface(grid), kTriangles);
    parts.push_back(fmt::format("made anew with {} triangles", sound.mesh.triangles.cols()));
  }
  note = fmt::format("{}", fmt::join(parts, ", "));
  return std::move(sound.mesh);
}

}  // namespace pliant
