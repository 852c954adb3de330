#include "pliant/geometry/meshing/stuffing.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pliant/geometry/distance/distance_grid.h"
#include "pliant/geometry/meshing/hole_filling.h"
#include "pliant/geometry/meshing/isosurface_stuffing.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr double kMaxSamples = 30e6;
constexpr int kMargin = 4;  // samples around the surface

double samples_for(const Eigen::AlignedBox3d& bounds, double cell_size) {
  return ((bounds.sizes() / (0.5 * cell_size)).array().ceil() + 1.0 + 2.0 * kMargin).prod();
}

TetrahedralMesh stuff_cells(const TriangleMesh& solid, const Eigen::AlignedBox3d& bounds,
                            double cell_size) {
  DistanceGrid grid;
  grid.spacing = 0.5 * cell_size;
  grid.count = ((bounds.sizes() / grid.spacing).array().ceil() + 1.0 + 2.0 * kMargin).cast<int>();
  grid.origin = bounds.center() - 0.5 * grid.spacing * (grid.count - 1).cast<double>().matrix();
  sample_signed_distance(solid, grid);
  return stuff_negative(grid);
}

double least_cell_size(const Eigen::AlignedBox3d& bounds) {
  // From below: samples fall as cells grow.
  double low = 0.0, high = bounds.sizes().maxCoeff();
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (samples_for(bounds, middle) > kMaxSamples ? low : high) = middle;
  }
  return high;
}

double checked_cell_size(const Eigen::AlignedBox3d& bounds, double cell_size,
                         const std::string& where) {
  const double longest = bounds.sizes().maxCoeff(), least = least_cell_size(bounds);
  if (cell_size >= least && cell_size <= longest) return cell_size;
  throw InputError(fmt::format(
      "{}: cell_size is {:g} m: allowed is [{:.3g}, {:.3g}] (finer asks for more than {:.3g} "
      "distance samples), or 0 to give a number of tetrahedra",
      where, cell_size, least, longest, kMaxSamples));
}

/// About so many come of cells of a size: twelve a cube of the lattice.
double tetrahedra_of(double volume, double cell_size) {
  return 12.0 * volume / std::pow(cell_size, 3.0);
}

/// Before any is made: the samples alone allow cells that make several times as many.
void check_tetrahedra(double volume, double cell_size, const std::string& where) {
  const double count = tetrahedra_of(volume, cell_size);
  if (count <= kMaxTetrahedra) return;
  throw InputError(fmt::format(
      "{}: cell_size is {:g} m and makes about {:.3g} tetrahedra, but at most {} are allowed: "
      "take {:.3g} m or more",
      where, cell_size, count, kMaxTetrahedra,
      std::cbrt(tetrahedra_of(volume, 1.0) / kMaxTetrahedra)));
}

/// Cells that make about as many tetrahedra: their number falls with the cube of the size, up to
/// what the surface adds.
TetrahedralMesh stuff_count(const TriangleMesh& solid, const Eigen::AlignedBox3d& bounds,
                            double target, const std::string& where) {
  // What may be missed by a twentieth must not be too many then.
  target = std::min(target, kMaxTetrahedra / 1.06);
  const double least = least_cell_size(bounds), longest = bounds.sizes().maxCoeff();
  double low = least, high = longest;  // sizes that make too many, too few
  double size = std::clamp(std::cbrt(12.0 * std::abs(signed_volume(solid)) / target), low, high);
  TetrahedralMesh best;
  double best_error = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < 12 && best_error > 0.05; ++attempt) {
    TetrahedralMesh mesh = stuff_cells(solid, bounds, size);
    const double count = static_cast<double>(mesh.tetrahedra.cols());
    const double error = std::abs(std::log(std::max(count, 0.1) / target));
    if (count > 0.0 && error < best_error) {
      best_error = error;
      best = std::move(mesh);
    }
    (count > target ? low : high) = size;
    size *= std::cbrt(std::max(count, 0.1) / target);
    if (!(size > low && size < high)) size = std::sqrt(low * high);
  }
  if (best_error > 0.05 && high <= 1.01 * least) {
    throw InputError(fmt::format(
        "{}: {:.0f} tetrahedra ask for cells below {:.3g} m and more than {:.3g} distance samples: "
        "choose fewer",
        where, target, least, kMaxSamples));
  }
  return best;
}

/// The surface with its small holes closed.
TriangleMesh closed_surface(const TriangleMesh& surface, double hole_size,
                            const std::string& where) {
  const std::vector<Hole> holes = find_holes(surface);
  const auto widest = std::max_element(
      holes.begin(), holes.end(), [](const Hole& a, const Hole& b) { return a.width < b.width; });
  if (widest != holes.end() && widest->width > hole_size) {
    throw InputError(fmt::format(
        "{}: the surface is open: of {} holes the widest, at vertex {}, has {} edges "
        "and is {:.3g} m wide; holes up to {:.3g} m (hole_size) are closed",
        where, holes.size(), widest->rim.front(), widest->rim.size(), widest->width, hole_size));
  }
  TriangleMesh solid = surface;
  fill_holes(solid, holes);
  return solid;
}

void check_options(const StuffingOptions& options, const std::string& where) {
  if (!std::isfinite(options.cell_size) || options.cell_size < 0.0) {
    throw InputError(
        fmt::format("{}: cell_size is {} m: allowed is > 0, or 0 to give a number of tetrahedra",
                    where, options.cell_size));
  }
  if (options.tetrahedra < 1 || options.tetrahedra > kMaxTetrahedra) {
    throw InputError(fmt::format("{}: tetrahedra is {}: allowed is [1, {}]", where,
                                 options.tetrahedra, kMaxTetrahedra));
  }
  if (std::isnan(options.hole_size)) {
    throw InputError(fmt::format("{}: hole_size is nan: allowed is any length [m]", where));
  }
}

}  // namespace

TetrahedralMesh stuff(const TriangleMesh& surface, const StuffingOptions& options,
                      const std::string& where) {
  validate(surface, where);
  check_options(options, where);
  const Eigen::AlignedBox3d bounds(surface.vertices.rowwise().minCoeff(),
                                   surface.vertices.rowwise().maxCoeff());
  const bool by_size = options.cell_size > 0.0;
  if (by_size) checked_cell_size(bounds, options.cell_size, where);
  // A surface with holes has no volume yet, its box has.
  const double guess =
      by_size ? options.cell_size : std::cbrt(12.0 * bounds.volume() / options.tetrahedra);
  const TriangleMesh solid =
      closed_surface(surface, options.hole_size < 0.0 ? guess : options.hole_size, where);
  const double volume = signed_volume(solid);
  if (volume < 0.0) {
    throw InputError(
        fmt::format("{}: the surface is inside out, it encloses {:.3g} m^3: reverse its triangles",
                    where, volume));
  }
  if (by_size) check_tetrahedra(volume, options.cell_size, where);
  TetrahedralMesh mesh = by_size ? stuff_cells(solid, bounds, options.cell_size)
                                 : stuff_count(solid, bounds, options.tetrahedra, where);
  if (mesh.tetrahedra.cols() > 0) return mesh;
  throw InputError(fmt::format(
      "{}: there is no interior: the solid ({:.3g} m^3 in a box of {:.3g} x {:.3g} x {:.3g} m) is "
      "too thin for its cells{}: choose a smaller cell_size",
      where, volume, bounds.sizes()[0], bounds.sizes()[1], bounds.sizes()[2],
      by_size ? fmt::format(" of {:g} m", options.cell_size) : ""));
}

}  // namespace pliant
