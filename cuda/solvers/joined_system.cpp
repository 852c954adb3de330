#include "cuda/solvers/joined_system.h"

#include <algorithm>

namespace pliant {
namespace {

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

void append_simplices(const PackedSimplices& from, int first_place, int first_material,
                      PackedSimplices& to) {
  to.corners = from.corners;
  to.shape_numbers = from.shape_numbers;
  const int first = to.size();
  for (std::size_t block = 1; block < from.begins.size(); ++block) {
    to.begins.push_back(first + from.begins[block]);
  }
  for (Int4 vertices : from.vertices) {
    for (int& v : vertices.v) v += first_place;
    to.vertices.push_back(vertices);
  }
  for (int material : from.material) to.material.push_back(first_material + material);
  append(from.slots, to.slots);
  append(from.weight, to.weight);
  append(from.ratio, to.ratio);
}

/// Each number of the shape is an array over all elements.
void join_shapes(const std::vector<const PackedSystem*>& systems,
                 PackedSimplices PackedSystem::*kind, PackedSimplices& to) {
  for (int k = 0; k < to.shape_numbers; ++k) {
    for (const PackedSystem* system : systems) {
      const PackedSimplices& from = system->*kind;
      const auto begin = from.shape.begin() + static_cast<std::ptrdiff_t>(k) * from.size();
      to.shape.insert(to.shape.end(), begin, begin + from.size());
    }
  }
}

}  // namespace

PackedSystem join(const std::vector<const PackedSystem*>& systems) {
  PackedSystem joined;
  joined.block = systems.front()->block;
  joined.scene_begins = {0};
  constexpr PackedSimplices PackedSystem::*kKinds[] = {
      &PackedSystem::tetrahedra, &PackedSystem::fibers, &PackedSystem::triangles};
  for (auto kind : kKinds) (joined.*kind).begins = {0};
  for (const PackedSystem* system : systems) {
    const int first = joined.blocks * joined.block;
    const int slices = system->blocks * system->block / SlicedRowsLayout::kSlice;
    append_rows(system->springs, first, slices, joined.springs);
    append_rows(system->quadratic, first, slices, joined.quadratic);
    append_clusters(system->clusters, first, system->blocks * system->block, joined.clusters);
    const int first_material = static_cast<int>(joined.materials.size());
    for (auto kind : kKinds) {
      append_simplices(system->*kind, first, first_material, joined.*kind);
    }
    append(system->materials, joined.materials);
    append(system->slot_begins, joined.slot_begins);
    joined.most_slots = std::max(joined.most_slots, system->most_slots);
    joined.blocks += system->blocks;
    joined.scene_begins.push_back(joined.blocks);
  }
  for (auto kind : kKinds) join_shapes(systems, kind, joined.*kind);
  joined.matrix = join_matrices(systems);
  joined.particles = joined.blocks * joined.block;
  return joined;
}

}  // namespace pliant
