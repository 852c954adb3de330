#include "cuda/solvers/matrix/packed_rows.h"

#include <algorithm>

#include "cuda/elements/place_pair.h"

namespace pliant {

SlicedRows sliced(const EntryRows& rows, int unroll, const std::vector<int>* places) {
  SlicedRows result;
  constexpr int kSlice = SlicedRows::kSlice;
  const int n = static_cast<int>(rows.size());
  for (int first = 0; first < n; first += kSlice) {
    std::size_t width = 0;
    for (int i = first; i < std::min(n, first + kSlice); ++i) {
      width = std::max(width, rows[static_cast<std::size_t>(i)].size());
    }
    const auto multiple = static_cast<std::size_t>(unroll);
    width = (width + multiple - 1) / multiple * multiple;
    for (std::size_t k = 0; k < width; ++k) {
      for (int lane = 0; lane < kSlice; ++lane) {
        const auto i = static_cast<std::size_t>(std::min(first + lane, n - 1));
        const auto& row = rows[i];
        const bool is_there = first + lane < n && k < row.size();
        const int own = places != nullptr ? (*places)[i] : static_cast<int>(i);
        const RowEntry entry = is_there ? row[k] : RowEntry{own, 0.0f, 0.0f};
        result.neighbors.push_back(entry.neighbor);
        result.a.push_back(entry.a);
        result.b.push_back(entry.b);
      }
    }
    result.begins.push_back(static_cast<int>(result.neighbors.size()));
  }
  return result;
}

namespace {

/// Of all blocks as many slices as they have, those of the last one as well; calls use(slice, b).
template <class Use>
void for_slices(const SlicedRows& rows, const BlockBorders& borders, LocalRows& result,
                const Use& use) {
  const int slices_of_block = borders.block() / SlicedRows::kSlice;
  for (std::size_t slice = 0; slice + 1 < rows.begins.size(); ++slice) {
    use(slice, static_cast<int>(slice) / slices_of_block);
  }
  const std::size_t slices =
      (borders.begins().size() - 1) * static_cast<std::size_t>(slices_of_block);
  result.begins.resize(slices + 1, result.begins.back());
}

}  // namespace

LocalRows localized_cells(const SlicedRows& threes, const BlockBorders& borders) {
  LocalRows result;
  constexpr int kSlice = SlicedRows::kSlice;
  for_slices(threes, borders, result, [&](std::size_t slice, int b) {
    for (int k = threes.begins[slice]; k < threes.begins[slice + 1]; k += 3 * kSlice) {
      for (int e = k; e < k + kSlice; ++e) {
        const auto number = [&](int which) {
          return borders.number(b, threes.neighbors[static_cast<std::size_t>(e + which * kSlice)]);
        };
        result.neighbors.push_back(number(0));
        result.a.push_back(bits_of({number(1), number(2)}));
        result.b.push_back(threes.b[static_cast<std::size_t>(e)]);
      }
    }
    result.begins.push_back(static_cast<int>(result.neighbors.size()));
  });
  return result;
}

LocalRows localized(const SlicedRows& rows, const BlockBorders& borders) {
  LocalRows result;
  result.begins = rows.begins;
  result.a = rows.a;
  result.b = rows.b;
  result.neighbors.reserve(rows.neighbors.size());
  for_slices(rows, borders, result, [&](std::size_t slice, int b) {
    for (int k = rows.begins[slice]; k < rows.begins[slice + 1]; ++k) {
      result.neighbors.push_back(borders.number(b, rows.neighbors[static_cast<std::size_t>(k)]));
    }
  });
  return result;
}

namespace {

/// All of rows but their neighbours.
template <class Rows>
void append_numbers(const Rows& from, int slices, Rows& to) {
  const int first = to.begins.back();
  for (std::size_t slice = 1; slice < from.begins.size(); ++slice) {
    to.begins.push_back(first + from.begins[slice]);
  }
  to.a.insert(to.a.end(), from.a.begin(), from.a.end());
  to.b.insert(to.b.end(), from.b.begin(), from.b.end());
  const int own = static_cast<int>(from.begins.size()) - 1;
  to.begins.insert(to.begins.end(), static_cast<std::size_t>(slices - own), to.begins.back());
}

}  // namespace

void append_rows(const SlicedRows& from, int first_place, int slices, SlicedRows& to) {
  append_numbers(from, slices, to);
  for (int neighbor : from.neighbors) to.neighbors.push_back(first_place + neighbor);
}

void append_rows(const LocalRows& from, int slices, LocalRows& to) {
  append_numbers(from, slices, to);
  to.neighbors.insert(to.neighbors.end(), from.neighbors.begin(), from.neighbors.end());
}

}  // namespace pliant
