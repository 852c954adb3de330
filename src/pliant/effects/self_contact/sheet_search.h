#pragma once

#include <cstddef>
#include <memory>

#include "pliant/core/body/particles.h"
#include "pliant/effects/self_contact/sheet_pairs.h"

namespace pliant {

class SheetTreeSearch;

/// The near pairs of a search, until its next call.
struct SheetNearPairs {
  const SheetNearPair* first = nullptr;
  std::size_t count = 0;

  std::size_t size() const { return count; }
  bool empty() const { return count == 0; }
  const SheetNearPair& operator[](std::size_t k) const { return first[k]; }
};

/// What a search has cost since it began, and how much the last call looked at.
struct SheetSearchCost {
  double transfers = 0.0;  ///< positions to the device [s]
  double follow = 0.0;     ///< how far all went [s]
  double collect = 0.0;    ///< candidates [s]
  double look = 0.0;       ///< at those that may be near [s]
  double gather = 0.0;     ///< what makes contacts, and its transfer to the host [s]
  int collections = 0, candidates = 0, awake = 0, near = 0;
};

/// Looks for what comes near of a sheet, and for what would pass, step after step.
class SheetSearch {
 public:
  virtual ~SheetSearch() = default;
  /// What comes nearer than its thickness and the margin on the straight paths from `start` to
  /// `end`: of each vertex the triangles with a nearest point of their own, then edges that are
  /// nearest within, in an order that no thread changes.
  virtual SheetNearPairs find(const Positions& start, const Positions& end) = 0;
  /// Whether nothing passes on the straight paths to `x` from the start of the last find(), or from
  /// where the last of these calls let it come. Else x goes back to where it may come, without
  /// moving fixed particles, and `found` is as of the rest of the path.
  virtual bool limit_displacement(const Particles& particles, Positions& x,
                                  SheetNearPairs& found) = 0;
  /// For those who time it; of the CPU's nothing.
  virtual SheetSearchCost cost() const { return {}; }
};

/// On the GPU: what `cpu` finds, to the bit and in its order. What it throws is a DeviceFailure,
/// and then nothing has changed.
std::unique_ptr<SheetSearch> make_cuda_sheet_search(const SheetTreeSearch& cpu);

/// What the CUDA backend makes it by (solvers/device/cuda_library.h).
using MakeCudaSheetSearch = void(const SheetTreeSearch& cpu, std::unique_ptr<SheetSearch>& search);
constexpr const char* kMakeCudaSheetSearch = "pliant_cuda_sheet_search";

}  // namespace pliant
