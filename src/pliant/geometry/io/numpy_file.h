#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/geometry/io/growing_file.h"

namespace pliant {

/// Writes an array of float64, rows first, as a .npy file (NumPy's format 1.0), which numpy.load()
/// reads. `values` holds as many numbers as `shape` says. Throws InputError when it cannot be
/// written.
void write_npy(const std::string& path, const std::vector<std::size_t>& shape,
               const std::vector<double>& values);

/// A .npy file of float64 items of one shape that grows: from its first publish() on it is whole at
/// any time. All throw InputError when it cannot be written.
class GrowingNpy {
 public:
  /// Of its items the first `kept` are there already and stay; 0: it is made anew, in place of
  /// another GrowingNpy only, unless `is_there`: then also what was written beyond these stays.
  GrowingNpy(const std::string& path, std::vector<std::size_t> item_shape, std::size_t kept,
             bool is_there = false);

  /// Numbers of an item.
  std::size_t item_size() const { return item_size_; }
  /// Puts numbers from the `offset`th of an item on; several threads may.
  void write(std::size_t item, std::size_t offset, const double* numbers, std::size_t count) const;
  /// Fills an item with NaN.
  void leave_out(std::size_t item) const;
  /// From now on it has so many items, all of which were written.
  void publish(std::size_t items) const;

 private:
  std::string header_of(std::size_t items) const;

  std::vector<std::size_t> shape_;
  std::size_t item_size_ = 1;
  std::optional<GrowingFile> file_;
};

}  // namespace pliant
