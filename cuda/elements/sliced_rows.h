#pragma once

#include "pliant/math/host_device.h"

namespace pliant {

/// For each particle the entries that it gathers, in slices of kSlice particles: entry k of
/// particle i stands at begins[i / kSlice] + kSlice k + i % kSlice, so that neighbouring threads
/// read neighbouring words. Shorter lists end with entries that point to the particle itself and
/// weigh nothing; all lengths are multiples of kUnroll, or of kShortUnroll: so many loads are under
/// way at once.
struct SlicedRowsLayout {
  static constexpr int kSlice = 32;
  static constexpr int kUnroll = 8;
  static constexpr int kShortUnroll = 4;  ///< of cells: a vertex of a grid has four
};

PLIANT_HOST_DEVICE inline int sliced(const int* begins, int i) {
  return begins[i / SlicedRowsLayout::kSlice] + i % SlicedRowsLayout::kSlice;
}
PLIANT_HOST_DEVICE inline int sliced_end(const int* begins, int i) {
  return begins[i / SlicedRowsLayout::kSlice + 1];
}

}  // namespace pliant
