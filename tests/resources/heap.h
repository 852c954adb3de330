#pragma once

#include <cstddef>

namespace pliant {

/// What the program takes from the heap, by whatever way (Eigen, operator new, C). Only one watch
/// at a time.
class HeapWatch {
 public:
  /// False where a sanitizer has the heap to itself: there are no figures then.
  static bool works();

  HeapWatch();
  int allocations() const;     ///< since it began
  std::size_t peak() const;    ///< largest growth of what is in use since it began [bytes]
  std::size_t in_use() const;  ///< growth of what is in use, if any [bytes]

 private:
  std::size_t start_;
};

}  // namespace pliant
