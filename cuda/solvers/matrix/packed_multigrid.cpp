#include "cuda/solvers/matrix/packed_multigrid.h"

#include <algorithm>

namespace pliant {
namespace {

constexpr int kSlice = SlicedRowsLayout::kSlice;

/// `from`'s row order(k) as row k, its columns as column(j). Rows are filled up with entries that
/// weigh nothing: with one that is there for certain.
template <class Order, class Column>
SlicedRows rows_of(const SparseRows& from, int unroll, const Order& order, const Column& column) {
  EntryRows rows(static_cast<std::size_t>(from.rows()));
  std::vector<int> filling(rows.size(), 0);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (SparseRows::InnerIterator entry(from, order(static_cast<int>(k))); entry; ++entry) {
      rows[k].push_back(
          {column(static_cast<int>(entry.col())), 0.0f, static_cast<float>(entry.value())});
    }
    if (!rows[k].empty()) filling[k] = rows[k].front().neighbor;
  }
  return sliced(rows, unroll, &filling);
}

int same(int i) { return i; }

SlicedRows matrix_of(const SparseRows& a) {
  EntryRows rows(static_cast<std::size_t>(a.rows()));
  for (int i = 0; i < a.rows(); ++i) {
    for (SparseRows::InnerIterator entry(a, i); entry; ++entry) {
      if (entry.col() == i) continue;
      rows[static_cast<std::size_t>(i)].push_back(
          {static_cast<int>(entry.col()), 0.0f, static_cast<float>(entry.value())});
    }
  }
  return sliced(rows, PackedMultigrid::kUnroll);
}

void set_rules(const MultigridLevel& level, PackedLevel& packed) {
  const Smoother& smoother = level.smoother;
  const auto rows = static_cast<std::size_t>(packed.slices() * kSlice);
  packed.diagonal.resize(rows, 1.0f);
  packed.rule.resize(rows, {0.0f, 0.0f, 0.0f, 0.0f});  // what no row has does not move
  for (int i = 0; i < level.a.rows(); ++i) {
    double sum = 0.0;
    for (SparseRows::InnerIterator entry(level.a, i); entry; ++entry) sum += entry.value();
    const double diagonal = level.diagonal[i], first = level.is_coarsest ? 1.0 : smoother.pull[0];
    packed.diagonal[static_cast<std::size_t>(i)] = static_cast<float>(diagonal);
    packed.rule[static_cast<std::size_t>(i)] = {
        static_cast<float>(first / diagonal), static_cast<float>(smoother.pull[1] / diagonal),
        static_cast<float>(smoother.momentum[1]), static_cast<float>(sum)};
  }
}

int bottom_of(const PackedMultigrid& packed) {
  const auto count = static_cast<int>(packed.levels.size());
  const int most = PackedMultigrid::kBlockLevels - (packed.has_coarsest ? 0 : 1);
  int bottom = count;
  while (bottom > 0 && count - bottom < most &&
         packed.levels[static_cast<std::size_t>(bottom) - 1].rows <=
             PackedMultigrid::kMostOfBlock) {
    --bottom;
  }
  return bottom;
}

/// Where each level of a scene begins in the pool.
std::vector<std::vector<int>> place_levels(const std::vector<SceneMultigrid>& scenes,
                                           MultigridPool& pool) {
  std::vector<std::vector<int>> begins(scenes.size());
  int rows = 0, launched = 0;
  const auto add = [&](std::size_t s, int level) {
    begins[s].push_back(rows);
    const int slices = scenes[s].packed->levels[static_cast<std::size_t>(level)].slices();
    pool.scene_of_slice.insert(pool.scene_of_slice.end(), static_cast<std::size_t>(slices),
                               static_cast<int>(s));
    rows += slices * kSlice;
  };
  for (const SceneMultigrid& scene : scenes) launched = std::max(launched, scene.packed->bottom);
  for (int level = 0; level < launched; ++level) {
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      if (level < scenes[s].packed->bottom) add(s, level);
    }
    pool.level_begins.push_back(rows);
  }
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const auto levels = static_cast<int>(scenes[s].packed->levels.size());
    for (int level = scenes[s].packed->bottom; level < levels; ++level) add(s, level);
  }
  return begins;
}

CycleBottom bottom_rows(const PackedMultigrid& packed, const std::vector<int>& begins) {
  CycleBottom bottom;
  const auto levels = static_cast<int>(packed.levels.size());
  for (int level = packed.bottom; level < levels; ++level) {
    const auto at = static_cast<std::size_t>(level);
    bottom.begin[bottom.levels] = begins[at];
    bottom.end[bottom.levels++] = begins[at] + packed.levels[at].rows;
  }
  bottom.has_coarsest = packed.has_coarsest && bottom.levels > 0;
  bottom.is_fine = packed.bottom == 0;
  std::copy(std::begin(packed.momentum), std::end(packed.momentum), bottom.momentum);
  std::copy(std::begin(packed.pull), std::end(packed.pull), bottom.pull);
  return bottom;
}

}  // namespace

PackedMultigrid pack_multigrid(const Multigrid& multigrid, const std::vector<int>& order,
                               const std::vector<int>& place) {
  PackedMultigrid packed;
  const auto place_of = [&](int i) { return place[static_cast<std::size_t>(i)]; };
  const auto order_of = [&](int k) { return order[static_cast<std::size_t>(k)]; };
  const auto& levels = multigrid.levels();
  for (std::size_t l = 0; l < levels.size() && levels[l].has_coarser(); ++l) {
    const SparseRows &p = levels[l].prolongation, &r = levels[l].restriction;
    constexpr int kUnroll = PackedMultigrid::kUnroll, kShort = PackedMultigrid::kProlongUnroll;
    PackedLevel next;
    next.rows = static_cast<int>(p.cols());
    if (l == 0) {
      packed.prolongation = rows_of(p, kShort, order_of, same);
      next.restriction = rows_of(r, kUnroll, same, place_of);
    } else {
      packed.levels.back().prolongation = rows_of(p, kShort, same, same);
      next.restriction = rows_of(r, kUnroll, same, same);
    }
    next.matrix = matrix_of(levels[l + 1].a);
    set_rules(levels[l + 1], next);
    packed.levels.push_back(std::move(next));
  }
  packed.has_coarsest = !levels.empty() && levels.back().is_coarsest;
  if (packed.has_coarsest) {
    const Smoother& smoother = levels.back().smoother;
    std::copy(smoother.momentum.begin(), smoother.momentum.end(), packed.momentum);
    std::copy(smoother.pull.begin(), smoother.pull.end(), packed.pull);
  }
  packed.bottom = bottom_of(packed);
  return packed;
}

MultigridPool pool_of(const std::vector<SceneMultigrid>& scenes) {
  MultigridPool pool;
  const std::vector<std::vector<int>> begins = place_levels(scenes, pool);
  std::vector<int> first_places;
  int first = 0;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const PackedMultigrid& packed = *scenes[s].packed;
    first_places.push_back(first);
    first += scenes[s].places;
    append_rows(packed.prolongation, begins[s].empty() ? 0 : begins[s].front(),
                scenes[s].places / kSlice, pool.fine);
    pool.bottoms.push_back(bottom_rows(packed, begins[s]));
  }
  const auto add = [&](std::size_t s, std::size_t l) {
    const PackedMultigrid& packed = *scenes[s].packed;
    const PackedLevel& level = packed.levels[l];
    const int coarser = l + 1 < packed.levels.size() ? begins[s][l + 1] : 0;
    append_rows(level.matrix, begins[s][l], level.slices(), pool.matrix);
    append_rows(level.restriction, l == 0 ? first_places[s] : begins[s][l - 1], level.slices(),
                pool.restriction);
    append_rows(level.prolongation, coarser, level.slices(), pool.prolongation);
    pool.diagonal.insert(pool.diagonal.end(), level.diagonal.begin(), level.diagonal.end());
    pool.rule.insert(pool.rule.end(), level.rule.begin(), level.rule.end());
  };
  for (std::size_t l = 0; l + 1 < pool.level_begins.size(); ++l) {
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      if (static_cast<int>(l) < scenes[s].packed->bottom) add(s, l);
    }
  }
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const PackedMultigrid& packed = *scenes[s].packed;
    for (auto l = static_cast<std::size_t>(packed.bottom); l < packed.levels.size(); ++l) add(s, l);
  }
  return pool;
}

}  // namespace pliant
