#include "cuda/solvers/packed_rows.h"

#include <algorithm>

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

void append_rows(const SlicedRows& from, int first_place, int slices, SlicedRows& to) {
  const int first = to.begins.back();
  for (std::size_t slice = 1; slice < from.begins.size(); ++slice) {
    to.begins.push_back(first + from.begins[slice]);
  }
  for (int neighbor : from.neighbors) to.neighbors.push_back(first_place + neighbor);
  to.a.insert(to.a.end(), from.a.begin(), from.a.end());
  to.b.insert(to.b.end(), from.b.begin(), from.b.end());
  const int own = static_cast<int>(from.begins.size()) - 1;
  to.begins.insert(to.begins.end(), static_cast<std::size_t>(slices - own), to.begins.back());
}

}  // namespace pliant
