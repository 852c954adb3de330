#pragma once

#include "cuda/solvers/device_step.h"

/// What a DeviceStep keeps of a packed system in the memory of its executor.
namespace pliant {

template <class Executor>
void DeviceStep<Executor>::bind_scenes() {
  if (scenes_ == 1) return;
  std::vector<int> scene_of_block;
  for (int scene = 0; scene < scenes_; ++scene) {
    const auto end = static_cast<std::size_t>(scene_begins_[static_cast<std::size_t>(scene) + 1]);
    scene_of_block.resize(end, scene);
  }
  arrays_.scene_of_block = put(scene_of_block_, scene_of_block);
}

template <class Executor>
void DeviceStep<Executor>::bind_elements(const PackedSystem& packed) {
  if (!packed.borders.empty()) {
    elements_.borders.begins = put(border_begins_, packed.borders.begins());
    elements_.borders.places = put(border_places_, packed.borders.places());
  }
  bind_rows(packed.springs, springs_, elements_.springs);
  bind_rows(packed.cells, cells_, elements_.cells);
  bind_rows(packed.quadratic, quadratic_, elements_.quadratic);
  const int copies = packed.shared_blocks == 0 ? 1 : packed.scenes();
  bind_simplices(packed.tetrahedra, copies, tetrahedra_, elements_.tetrahedra);
  bind_simplices(packed.fibers, copies, fibers_, elements_.fibers);
  bind_simplices(packed.triangles, copies, triangles_, elements_.triangles);
  if (packed.most_slots > 0) elements_.slot_begins = put(slot_begins_, packed.slot_begins);
  if (!packed.materials.empty()) elements_.materials = put(materials_, packed.materials);
  elements_.shared_blocks = packed.shared_blocks;
  shared_ = {packed.block, packed.borders.most(), packed.most_slots, packed.passes};
}

template <class Executor>
void DeviceStep<Executor>::plan_persistent(const PackedSystem& packed) {
  shared_places_ = {};
  mailboxes_.resize(0);
  if (packed.passes > 1 || elements_.clusters.clusters > 0) return;
  if (matrix_.kind() != DeviceIteration::kJacobi) return;
  const auto count = [](const std::vector<int>& begins, int block, int stride) {
    if (begins.size() <= 1) return 0;
    return BlockCounts::count(begins.data(), block, stride);
  };
  const int slices = packed.block / SlicedRowsLayout::kSlice;
  const int blocks = packed.shared_blocks > 0 ? packed.shared_blocks : packed.blocks;
  BlockCounts most;
  const auto raise = [](int& value, int other) { value = std::max(value, other); };
  for (int b = 0; b < blocks; ++b) {
    raise(most.tetrahedra, count(packed.tetrahedra.begins, b, 1));
    raise(most.fibers, count(packed.fibers.begins, b, 1));
    raise(most.triangles, count(packed.triangles.begins, b, 1));
    raise(most.springs, count(packed.springs.begins, b, slices));
    raise(most.cells, count(packed.cells.begins, b, slices));
    raise(most.quadratic, count(packed.quadratic.begins, b, slices));
  }
  shared_places_ = SharedMemoryPlaces(shared_, most);
  mailboxes_.resize(static_cast<std::size_t>(PersistentIteration::kPackets * packed.blocks));
}

template <class Executor>
void DeviceStep<Executor>::bind_rows(const LocalRows& rows, RowArrays& to, LocalRowsView& view) {
  if (rows.empty()) return;
  view.begins = put(to.begins, rows.begins);
  view.neighbors = put(to.neighbors, rows.neighbors);
  view.a = put(to.a, rows.a);
  view.b = put(to.b, rows.b);
}

template <class Executor>
void DeviceStep<Executor>::bind_simplices(const PackedSimplices& simplices, int copies,
                                          SimplexArrays& to, SimplicesView& view) {
  if (simplices.size() == 0) return;
  view.size = simplices.size();
  view.begins = put(to.begins, simplices.begins);
  view.places = put(to.places, simplices.places);
  view.slots = put(to.slots, simplices.slots);
  view.numbers = put(to.numbers, simplices.numbers);
  if (simplices.corners != 4) return;
  // Zero: nobody knows.
  to.rotation.resize(static_cast<std::size_t>(copies) * simplices.places.size());
  view.rotation = to.rotation.data();
}

}  // namespace pliant
