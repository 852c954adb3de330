#include "pliant/geometry/repair/mesh_collider.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pliant/geometry/repair/convex_hull.h"
#include "pliant/geometry/repair/isosurface.h"
#include "pliant/geometry/repair/solid_samples.h"
#include "pliant/geometry/repair/sound_mesh.h"
#include "pliant/geometry/search/nearest_triangle.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr double kMostToRepair = 0.75;  // share that closes holes or bounds nothing, if asked for
constexpr double kNearHull = 0.02;      // of the longest side
constexpr int kFiner = 2;               // halvings of a voxel that is chosen
constexpr double kMostFinerSamples = 4e6;

Eigen::AlignedBox3d bounds_of(const TriangleMesh& mesh) {
  return {Eigen::Vector3d(mesh.vertices.rowwise().minCoeff()),
          Eigen::Vector3d(mesh.vertices.rowwise().maxCoeff())};
}

class ColliderMaker {
 public:
  ColliderMaker(const TriangleMesh& mesh, const ColliderOptions& options)
      : options_(options), mesh_(make_sound(mesh)), bounds_(bounds_of(mesh_.mesh)) {
    lay_grid(bounds_, options.voxel_size);  // refuses what no kind takes
    const double longest = bounds_.sizes().maxCoeff();
    if (!(options.thickness >= 0.0 && options.thickness <= longest)) {
      throw InputError(fmt::format("thickness is {} m: allowed is (0, {:g}], or 0 for two voxels",
                                   options.thickness, longest));
    }
  }

  MeshCollider make() {
    switch (options_.kind) {
      case ColliderKind::kExact:
        return exact_or_refuse();
      case ColliderKind::kRepaired:
        return repaired_or_refuse();
      case ColliderKind::kConvex:
        return convex_or_refuse();
      case ColliderKind::kThickShell:
        return thick_shell({"as asked for"});
      case ColliderKind::kAuto:
        break;
    }
    return choose();
  }

 private:
  MeshCollider choose() {
    if (mesh_.closed && !mesh_.overlaps) {
      if (auto shape = exact(mesh_.mesh)) {
        return {shape, ColliderKind::kExact, kind_and("exact", mesh_.faults)};
      }
      return thick_shell({"the solid is thinner than its samples are apart"});
    }
    SolidSamples found;
    auto shape = repaired(found);
    if (shape != nullptr && found.is_plausible()) {
      return {shape, ColliderKind::kRepaired, repaired_note(found)};
    }
    std::vector<std::string> why = found.phrases();
    if (!found.has_inside) why = {"it bounds no solid"};
    if (is_near_hull()) {
      if (auto shape = convex()) {
        return {shape, ColliderKind::kConvex, kind_and("convex", joined_faults(why))};
      }
    }
    return thick_shell(why);
  }

  MeshCollider exact_or_refuse() {
    if (!mesh_.closed) {
      throw InputError(fmt::format("mesh shape: collider 'exact' needs a closed surface: {}",
                                   fmt::join(mesh_.faults, ", ")));
    }
    auto shape = exact(mesh_.mesh);
    if (shape == nullptr) refuse_thin("exact");
    return {shape, ColliderKind::kExact, kind_and("exact", mesh_.faults)};
  }

  MeshCollider repaired_or_refuse() {
    SolidSamples found;
    auto shape = repaired(found);
    if (shape == nullptr) refuse_thin("repaired");
    if (std::max(found.closed, found.loose) > kMostToRepair) {
      throw InputError(fmt::format(
          "mesh shape: collider 'repaired' has no inside: {}; choose convex or thick_shell",
          fmt::join(joined_faults(found.phrases()), ", ")));
    }
    return {shape, ColliderKind::kRepaired, repaired_note(found)};
  }

  MeshCollider convex_or_refuse() {
    auto shape = convex();
    if (shape == nullptr) refuse_thin("convex");
    return {shape, ColliderKind::kConvex, "convex (as asked for)"};
  }

  [[noreturn]] void refuse_thin(const char* kind) const {
    throw InputError(fmt::format(
        "mesh shape: collider '{}' has no inside at samples {:g} m apart (the mesh measures {:g} x "
        "{:g} x {:g} m): choose a smaller voxel_size, or collider thick_shell",
        kind, lay_grid(bounds_, options_.voxel_size).spacing, bounds_.sizes()[0],
        bounds_.sizes()[1], bounds_.sizes()[2]));
  }

  /// Calls sample(grid) with finer and finer grids until one has an inside; null when none has.
  template <class Sample>
  std::optional<DistanceGrid> sampled(const Sample& sample) const {
    DistanceGrid grid = lay_grid(bounds_, options_.voxel_size);
    for (int halvings = 0;; ++halvings) {
      sample(grid);
      if (has_inside(grid)) return grid;
      const bool is_finest = options_.voxel_size > 0.0 || halvings == kFiner ||
                             4.0 * grid.count.cast<double>().prod() > kMostFinerSamples;
      if (is_finest) return std::nullopt;
      grid = lay_grid(bounds_, 0.5 * grid.spacing);
    }
  }

  std::shared_ptr<const MeshShape> exact(const TriangleMesh& closed) const {
    std::optional<DistanceGrid> grid =
        sampled([&](DistanceGrid& grid) { sample_signed_distance(closed, grid); });
    return grid ? std::make_shared<MeshShape>(closed, std::move(*grid)) : nullptr;
  }

  std::shared_ptr<const MeshShape> repaired(SolidSamples& found) const {
    std::optional<DistanceGrid> grid =
        sampled([&](DistanceGrid& grid) { found = sample_solid(mesh_.mesh, grid); });
    if (!grid) return nullptr;
    TriangleMesh surface = isosurface(*grid);
    return std::make_shared<MeshShape>(std::move(surface), std::move(*grid));
  }

  std::shared_ptr<const MeshShape> convex() const {
    return exact(convex_hull(mesh_.mesh.vertices));
  }

  MeshCollider thick_shell(const std::vector<std::string>& why) const {
    const double spacing = lay_grid(bounds_, options_.voxel_size).spacing;
    const double thickness = options_.thickness > 0.0 ? options_.thickness : 2.0 * spacing;
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * thickness);
    DistanceGrid grid =
        lay_grid(Eigen::AlignedBox3d(bounds_.min() - half, bounds_.max() + half), spacing);
    sample_shell(mesh_.mesh, thickness, grid);
    if (!has_inside(grid)) {
      throw InputError(fmt::format(
          "mesh shape: a thick shell of {:g} m has no inside at samples {:g} m apart: choose a "
          "greater thickness or a smaller voxel_size",
          thickness, spacing));
    }
    TriangleMesh surface = isosurface(grid);
    std::vector<std::string> parts = joined_faults(why);
    parts.insert(parts.begin(), fmt::format("{:.2g} mm thick", 1e3 * thickness));
    return {std::make_shared<MeshShape>(std::move(surface), std::move(grid)),
            ColliderKind::kThickShell, kind_and("thick_shell", parts)};
  }

  bool is_near_hull() const {
    try {
      const NearestTriangle hull(convex_hull(mesh_.mesh.vertices));
      double area = 0.0, sum = 0.0;
      for (const auto t : mesh_.mesh.triangles.colwise()) {
        const Eigen::Vector3d a = mesh_.mesh.vertices.col(t[0]), b = mesh_.mesh.vertices.col(t[1]),
                              c = mesh_.mesh.vertices.col(t[2]);
        const double weight = 0.5 * (b - a).cross(c - a).norm();
        area += weight;
        sum += weight * hull((a + b + c) / 3.0).distance;
      }
      return sum <= kNearHull * bounds_.sizes().maxCoeff() * area;
    } catch (const InputError&) {
      return false;  // flat: it has no hull
    }
  }

  std::vector<std::string> joined_faults(const std::vector<std::string>& more) const {
    std::vector<std::string> parts = mesh_.faults;
    parts.insert(parts.end(), more.begin(), more.end());
    return parts;
  }

  std::string repaired_note(const SolidSamples& found) const {
    return kind_and("repaired", joined_faults(found.phrases()));
  }

  static std::string kind_and(const std::string& kind, const std::vector<std::string>& parts) {
    return parts.empty() ? kind : fmt::format("{} ({})", kind, fmt::join(parts, ", "));
  }

  const ColliderOptions& options_;
  SoundMesh mesh_;
  Eigen::AlignedBox3d bounds_;
};

const std::vector<std::pair<ColliderKind, std::string>>& kinds_and_names() {
  static const std::vector<std::pair<ColliderKind, std::string>> all = {
      {ColliderKind::kAuto, "auto"},
      {ColliderKind::kExact, "exact"},
      {ColliderKind::kRepaired, "repaired"},
      {ColliderKind::kConvex, "convex"},
      {ColliderKind::kThickShell, "thick_shell"}};
  return all;
}

}  // namespace

const std::vector<std::string>& collider_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const auto& [kind, name] : kinds_and_names()) list.push_back(name);
    return list;
  }();
  return names;
}

std::string collider_name(ColliderKind kind) {
  return collider_names()[static_cast<std::size_t>(kind)];
}

ColliderKind find_collider(const std::string& name) {
  for (const auto& [kind, own_name] : kinds_and_names()) {
    if (own_name == name) return kind;
  }
  throw InputError(unknown_name_message("collider", name, collider_names()));
}

MeshCollider make_mesh_collider(const TriangleMesh& mesh, const ColliderOptions& options) {
  return ColliderMaker(mesh, options).make();
}

}  // namespace pliant
