#pragma once

#include <limits>

#include "cuda/core/vector.h"
#include "cuda/effects/sheet_follow.h"
#include "cuda/geometry/device_tree.h"

/// Pairs that may come near soon: kernels of DeviceSheetSearch.
namespace pliant {

/// Pairs of vertices and triangles, then of edges.
struct SheetCandidates {
  Int4* particles;
  double* thickness;  ///< [m]
  double* wake;       ///< of the path: before, it cannot be near [m]
  SheetGap* gap;
  int vertex_pairs, pairs;

  PLIANT_HOST_DEVICE SimplexPair kind(int c) const {
    return c < vertex_pairs ? SimplexPair::kPointTriangle : SimplexPair::kSegments;
  }
};

namespace sheet_kernels {

struct BeginCollection {
  SheetPlaces places;
  double mean_edge;
  PLIANT_HOST_DEVICE void operator()(int i) const {
    const Double3 start = places.start[i], end = places.end[i];
    places.slacks[i] = sheet_pairs::slack(start, end, mean_edge);
    places.collected_start[i] = start;
    places.collected_end[i] = end;
  }
};

/// Around a vertex's path, wider by `half` and by its slack.
PLIANT_HOST_DEVICE inline DeviceBox box_of(const SheetPlaces& places, int i, double reach) {
  const Double3 a = places.start[i], b = places.end[i];
  const double half = reach + places.slacks[i];
  return {{lesser(a.x, b.x) - half, lesser(a.y, b.y) - half, lesser(a.z, b.z) - half},
          {greater(a.x, b.x) + half, greater(a.y, b.y) + half, greater(a.z, b.z) + half}};
}

/// Of simplices by rank, whose corners lie side by side.
template <int kCorners>
struct EncloseSimplices {
  SheetPlaces places;
  double reach;
  const int* corners;
  DeviceBox* boxes;
  PLIANT_HOST_DEVICE void operator()(int rank) const {
    DeviceBox box = DeviceBox::empty();
    for (int k = 0; k < kCorners; ++k) {
      box.extend(box_of(places, corners[kCorners * rank + k], reach));
    }
    boxes[rank] = box.is_finite() ? box : DeviceBox::empty();
  }
};

/// The simplices of a sheet by their ranks in the trees.
struct SheetSimplices {
  DeviceTreeView triangles, edges;
  const int* corners;       ///< three a triangle
  const int* ends;          ///< two an edge
  const int* edge_numbers;  ///< the sheet's
  int vertices;
};

/// Counts or lists the candidates of a vertex, or of the edge of a rank. Rows are vertices, then
/// edges by their numbers.
struct CollectPairs {
  SheetSimplices sheet;
  SheetPlaces places;
  double reach;
  int* counts;        ///< by row
  const int* begins;  ///< likewise; null: counts
  Int4* particles;

  PLIANT_HOST_DEVICE void operator()(int k) const {
    if (k < sheet.vertices) {
      AroundVertex around{*this, k, begins == nullptr ? 0 : begins[k]};
      sheet.triangles.for_each_overlapping(box_of(places, k, reach), around);
      if (begins == nullptr) counts[k] = around.next;
    } else {
      const int rank = k - sheet.vertices;
      const int row = sheet.vertices + sheet.edge_numbers[rank];
      AroundEdge around{*this, rank, begins == nullptr ? 0 : begins[row]};
      sheet.edges.for_each_overlapping(sheet.edges.boxes[rank], around);
      if (begins == nullptr) counts[row] = around.next;
    }
  }

 private:
  struct AroundVertex {
    const CollectPairs& all;
    int vertex, next;
    PLIANT_HOST_DEVICE void operator()(int rank) {
      const int* c = all.sheet.corners + 3 * rank;
      if (c[0] == vertex || c[1] == vertex || c[2] == vertex) return;
      if (all.begins != nullptr) all.particles[next] = {{vertex, c[0], c[1], c[2]}};
      ++next;
    }
  };
  struct AroundEdge {
    const CollectPairs& all;
    int own, next;
    PLIANT_HOST_DEVICE void operator()(int rank) {
      if (all.sheet.edge_numbers[rank] <= all.sheet.edge_numbers[own]) return;
      const int *a = all.sheet.ends + 2 * own, *b = all.sheet.ends + 2 * rank;
      if (b[0] == a[0] || b[0] == a[1] || b[1] == a[0] || b[1] == a[1]) return;
      if (all.begins != nullptr) all.particles[next] = {{a[0], a[1], b[0], b[1]}};
      ++next;
    }
  };
};

/// Whether their number is one of 32 bits.
struct AddCounts {
  static constexpr int kRun = 256;
  const int* counts;
  int rows;
  SheetTally* tally;
  PLIANT_HOST_DEVICE void operator()(int run) const {
    SharedCount sum = 0;
    for (int r = run * kRun; r < rows && r < (run + 1) * kRun; ++r) {
      sum += static_cast<SharedCount>(counts[r]);
    }
    add_shared(&tally->pairs, sum);
  }
};

struct BeginCandidates {
  SheetCandidates candidates;
  SheetJoints joints;
  const Double3* start;
  double thickness;  ///< the sheet's [m]
  PLIANT_HOST_DEVICE void operator()(int c) const {
    const SimplexPair kind = candidates.kind(c);
    const Int4 own = candidates.particles[c];
    const double kept = sheet_pairs::thickness_of(joints, kind, own.v, thickness);
    const bool counts = kept > 0.0;
    candidates.thickness[c] = kept;
    candidates.wake[c] = counts ? 0.0 : HUGE_VAL;
    candidates.gap[c] = sheet_pairs::first_gap(kind, sheet_pairs::places(start, own.v));
  }
};

}  // namespace sheet_kernels
}  // namespace pliant
