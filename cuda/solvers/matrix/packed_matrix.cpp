#include "cuda/solvers/matrix/packed_matrix.h"

#include <algorithm>

#include "cuda/solvers/scenes/packed_system.h"

namespace pliant {
namespace {

constexpr int kNone = -1;  // rank of a fixed particle

/// Groups of particles that move at the same time, one after the other.
std::vector<const std::vector<int>*> groups_of(const VertexColoring& coloring) {
  std::vector<const std::vector<int>*> groups;
  for (const std::vector<int>& color : coloring.colors) {
    if (!color.empty()) groups.push_back(&color);
  }
  if (!coloring.overflow.empty()) groups.push_back(&coloring.overflow);
  return groups;
}

template <class Use>
void for_each_entry(const SparseRows& a, int i, const Use& use) {
  for (SparseRows::InnerIterator entry(a, i); entry; ++entry) {
    if (entry.col() != i && entry.value() != 0.0) use(static_cast<int>(entry.col()), entry.value());
  }
}

void append_level(const PackedMatrix& from, int level, int first_place, PackedMatrix& to) {
  constexpr int kSlice = SlicedRowsLayout::kSlice;
  const auto at = static_cast<std::size_t>(level);
  for (int k = from.level_begins[at]; k < from.level_begins[at + 1]; ++k) {
    const int place = from.members[static_cast<std::size_t>(k)];
    to.members.push_back(place < 0 ? place : first_place + place);
  }
  for (int s = from.level_begins[at] / kSlice; s < from.level_begins[at + 1] / kSlice; ++s) {
    const auto slice = static_cast<std::size_t>(s);
    for (int e = from.rows.begins[slice]; e < from.rows.begins[slice + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      to.rows.neighbors.push_back(first_place + from.rows.neighbors[entry]);
      to.rows.a.push_back(from.rows.a[entry]);
      to.rows.b.push_back(from.rows.b[entry]);
    }
    to.rows.begins.push_back(static_cast<int>(to.rows.neighbors.size()));
  }
}

}  // namespace

PackedMatrix pack_whole(const SparseRows& a, const DeviceIteration& iteration,
                        const Eigen::VectorXd& inertia, const PackedSystem& packed) {
  PackedMatrix result;
  result.kind = iteration.kind;
  result.history = iteration.history;
  result.sweeps = iteration.sweeps;
  EntryRows rows(packed.order.size());
  result.held.resize(packed.order.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int i = packed.order[k];
    double sum = a.coeff(i, i) - inertia[i];
    for_each_entry(a, i, [&](int j, double value) {
      sum += value;
      rows[k].push_back(
          {packed.place[static_cast<std::size_t>(j)], 0.0f, static_cast<float>(value)});
    });
    result.held[k] = static_cast<float>(sum);
  }
  result.rows = sliced(rows, PackedMatrix::kUnroll);
  return result;
}

PackedMatrix pack_sweep(const SparseRows& a, const VertexColoring& coloring,
                        const PackedSystem& packed) {
  PackedMatrix result;
  result.kind = DeviceIteration::kSweep;
  result.colors = static_cast<int>(coloring.colors.size());
  result.overflow = static_cast<int>(coloring.overflow.size());
  const auto groups = groups_of(coloring);
  std::vector<int> ranks(packed.order.size(), kNone);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (int i : *groups[g]) ranks[static_cast<std::size_t>(i)] = static_cast<int>(g);
  }
  EntryRows rows;
  std::vector<int> own;  // place of each row, that of a neighbour in the same slice where none is
  for (std::size_t g = 1; g < groups.size(); ++g) {
    std::vector<int> places;  // in the order of places: what lies close together is read together
    for (int i : *groups[g]) places.push_back(packed.place[static_cast<std::size_t>(i)]);
    std::sort(places.begin(), places.end());
    for (int place : places) {
      const int i = packed.order[static_cast<std::size_t>(place)];
      auto& row = rows.emplace_back();
      for_each_entry(a, i, [&](int j, double value) {
        const int rank = ranks[static_cast<std::size_t>(j)];
        if (rank == kNone || rank >= static_cast<int>(g)) return;
        row.push_back({packed.place[static_cast<std::size_t>(j)], 0.0f, static_cast<float>(value)});
      });
      result.members.push_back(place);
      own.push_back(place);
    }
    while (rows.size() % SlicedRowsLayout::kSlice != 0) {
      rows.emplace_back();
      result.members.push_back(-1);
      own.push_back(places.back());
    }
    result.level_begins.push_back(static_cast<int>(rows.size()));
  }
  result.rows = sliced(rows, PackedMatrix::kSweepUnroll, &own);
  const Eigen::VectorXd sums = overflow_row_sums(a, coloring);
  for (int i : packed.order) result.overflow_sums.push_back(static_cast<float>(sums[i]));
  return result;
}

PackedMatrix join_matrices(const std::vector<const PackedSystem*>& systems) {
  PackedMatrix joined;
  joined.kind = systems.front()->matrix.kind;
  joined.history = systems.front()->matrix.history;
  joined.sweeps = systems.front()->matrix.sweeps;
  if (joined.kind == DeviceIteration::kJacobi) return joined;
  int first = 0, levels = 0;
  std::vector<int> first_places;
  for (const PackedSystem* system : systems) {
    const PackedMatrix& own = system->matrix;
    const int places = system->blocks * system->block;
    joined.multigrids.insert(joined.multigrids.end(), own.multigrids.begin(), own.multigrids.end());
    first_places.push_back(first);
    first += places;
    levels = std::max(levels, own.levels());
    // What no particle has, at the end of the last block, is zero.
    joined.held.insert(joined.held.end(), own.held.begin(), own.held.end());
    joined.held.resize(static_cast<std::size_t>(first), 0.0f);
    joined.overflow_sums.insert(joined.overflow_sums.end(), own.overflow_sums.begin(),
                                own.overflow_sums.end());
    joined.overflow_sums.resize(static_cast<std::size_t>(first), 0.0f);
    if (joined.kind != DeviceIteration::kSweep) {
      append_rows(own.rows, first_places.back(), places / SlicedRowsLayout::kSlice, joined.rows);
    }
  }
  for (int level = 0; level < levels; ++level) {
    for (std::size_t s = 0; s < systems.size(); ++s) {
      const PackedMatrix& own = systems[s]->matrix;
      if (level < own.levels()) append_level(own, level, first_places[s], joined);
    }
    joined.level_begins.push_back(static_cast<int>(joined.members.size()));
  }
  return joined;
}

}  // namespace pliant
