#pragma once

#include <vector>

#include "cuda/elements/sliced_rows.h"
#include "cuda/solvers/blocks/block_borders.h"

namespace pliant {

/// Rows of entries, one row a particle (SlicedRowsLayout).
struct SlicedRows : SlicedRowsLayout {
  std::vector<int> begins = {0};
  std::vector<int> neighbors;
  std::vector<float> a, b;

  bool empty() const { return neighbors.empty(); }
};

/// The same of neighbours that a block's threads share (BlockBorders): numbers within the block.
struct LocalRows : SlicedRowsLayout {
  std::vector<int> begins = {0};
  std::vector<unsigned short> neighbors;
  std::vector<float> a, b;

  bool empty() const { return neighbors.empty(); }
};

struct RowEntry {
  int neighbor;
  float a, b;
};
using EntryRows = std::vector<std::vector<RowEntry>>;

/// Lengths become multiples of `unroll`; `places` of the rows' own particles, where row k is not
/// that of place k.
SlicedRows sliced(const EntryRows& rows, int unroll = SlicedRowsLayout::kUnroll,
                  const std::vector<int>* places = nullptr);

/// `rows` with neighbours numbered within blocks.
LocalRows localized(const SlicedRows& rows, const BlockBorders& borders);

/// Rows of cells from entries by threes, the opposite corner and then both ends of the other
/// diagonal: an entry each, with these two in the bits of `a` (PlacePair).
LocalRows localized_cells(const SlicedRows& threes, const BlockBorders& borders);

/// Puts rows of places behind those of others, as the `slices` of places that begin at
/// `first_place`.
void append_rows(const SlicedRows& from, int first_place, int slices, SlicedRows& to);
/// Behind others, as `slices` of them.
void append_rows(const LocalRows& from, int slices, LocalRows& to);

}  // namespace pliant
