#pragma once

#include <vector>

namespace pliant {

/// Which corners of which elements each particle is, so that each can collect what elements push it
/// with: threads then meet twice, and not once for each of dozens of colours, and what one of them
/// works on stays in its cache, but for elements at the border of its particles.
struct EntriesOfParticles {
  EntriesOfParticles() = default;
  /// `vertices` are the particles of all corners, `corners` an element.
  EntriesOfParticles(const std::vector<int>& vertices, int corners);

  std::vector<int> particles;  ///< ascending
  std::vector<int> begins;     ///< first entry of each, and the end
  std::vector<int> entries;    ///< places in `vertices`, ascending for each particle
  std::vector<int> order;      ///< elements by the means of their particles' numbers
};

}  // namespace pliant
