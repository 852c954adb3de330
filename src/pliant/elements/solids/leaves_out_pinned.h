#pragma once

#include "pliant/core/body/particles.h"

namespace pliant {

/// Offered by element sets whose parts depend on which particles are pinned.
class LeavesOutPinned {
 public:
  virtual ~LeavesOutPinned() = default;
  /// Makes its parts anew if other particles are pinned than when it made them; whether it did.
  virtual bool leave_out_pinned(const Particles& particles) = 0;
};

}  // namespace pliant
