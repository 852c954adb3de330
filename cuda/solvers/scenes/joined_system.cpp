#include "cuda/solvers/scenes/joined_system.h"

#include <algorithm>
#include <cstring>

namespace pliant {
namespace {

constexpr PackedSimplices PackedSystem::*kKinds[] = {
    &PackedSystem::tetrahedra, &PackedSystem::fibers, &PackedSystem::triangles};

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

void append_simplices(const PackedSimplices& from, PackedSimplices& to) {
  to.corners = from.corners;
  to.quads = from.quads;
  const int first = to.size();
  for (std::size_t block = 1; block < from.begins.size(); ++block) {
    to.begins.push_back(first + from.begins[block]);
  }
  append(from.places, to.places);
  append(from.slots, to.slots);
}

/// Each quad is an array over all elements. Triangles' materials follow those of systems before.
void join_numbers(const std::vector<const PackedSystem*>& systems,
                  PackedSimplices PackedSystem::*kind, PackedSimplices& to) {
  for (int q = 0; q < to.quads; ++q) {
    std::size_t first_material = 0;
    for (const PackedSystem* system : systems) {
      const PackedSimplices& from = system->*kind;
      const auto begin = from.numbers.begin() + static_cast<std::ptrdiff_t>(q) * from.size();
      for (auto numbers = begin; numbers != begin + from.size(); ++numbers) {
        to.numbers.push_back(*numbers);
        if (to.corners == 3 && q == 1) to.numbers.back().y += static_cast<float>(first_material);
      }
      first_material += system->materials.size();
    }
  }
}

template <class T>
bool is_same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}
bool is_same(const LocalRows& a, const LocalRows& b) {
  return is_same(a.begins, b.begins) && is_same(a.neighbors, b.neighbors) && is_same(a.a, b.a) &&
         is_same(a.b, b.b);
}
bool is_same(const PackedSimplices& a, const PackedSimplices& b) {
  return is_same(a.begins, b.begins) && is_same(a.places, b.places) && is_same(a.slots, b.slots) &&
         is_same(a.numbers, b.numbers);
}
/// Whether both read the same springs, cells, bending and simplices.
bool has_same_elements(const PackedSystem& a, const PackedSystem& b) {
  return a.blocks == b.blocks && is_same(a.borders.begins(), b.borders.begins()) &&
         is_same(a.borders.places(), b.borders.places()) && is_same(a.springs, b.springs) &&
         is_same(a.cells, b.cells) && is_same(a.quadratic, b.quadratic) &&
         is_same(a.slot_begins, b.slot_begins) && is_same(a.materials, b.materials) &&
         std::all_of(std::begin(kKinds), std::end(kKinds),
                     [&](auto kind) { return is_same(a.*kind, b.*kind); });
}

void take_elements(const PackedSystem& from, PackedSystem& to) {
  to.borders = from.borders;
  to.springs = from.springs;
  to.cells = from.cells;
  to.quadratic = from.quadratic;
  for (auto kind : kKinds) to.*kind = from.*kind;
  to.materials = from.materials;
  to.slot_begins = from.slot_begins;
  to.most_slots = from.most_slots;
  to.shared_blocks = from.blocks;
}

void join_elements(const std::vector<const PackedSystem*>& systems, PackedSystem& joined) {
  for (auto kind : kKinds) (joined.*kind).begins = {0};
  int blocks = 0;
  for (const PackedSystem* system : systems) {
    const int slices = system->blocks * system->block / SlicedRowsLayout::kSlice;
    joined.borders.append(system->borders, system->blocks, blocks * joined.block);
    append_rows(system->springs, slices, joined.springs);
    append_rows(system->cells, slices, joined.cells);
    append_rows(system->quadratic, slices, joined.quadratic);
    for (auto kind : kKinds) append_simplices(system->*kind, joined.*kind);
    append(system->materials, joined.materials);
    append(system->slot_begins, joined.slot_begins);
    joined.most_slots = std::max(joined.most_slots, system->most_slots);
    blocks += system->blocks;
  }
  for (auto kind : kKinds) join_numbers(systems, kind, joined.*kind);
}

}  // namespace

PackedSystem join(const std::vector<const PackedSystem*>& systems) {
  PackedSystem joined;
  joined.block = systems.front()->block;
  joined.passes = systems.front()->passes;
  joined.scene_begins = {0};
  for (const PackedSystem* system : systems) {
    append_clusters(system->clusters, joined.blocks * joined.block, system->blocks * system->block,
                    joined.clusters);
    joined.blocks += system->blocks;
    joined.scene_begins.push_back(joined.blocks);
  }
  const bool all_same = std::all_of(
      systems.begin() + 1, systems.end(),
      [&](const PackedSystem* system) { return has_same_elements(*systems.front(), *system); });
  if (all_same) {
    take_elements(*systems.front(), joined);
  } else {
    join_elements(systems, joined);
  }
  joined.matrix = join_matrices(systems);
  joined.particles = joined.blocks * joined.block;
  return joined;
}

}  // namespace pliant
