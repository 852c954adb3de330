#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

/// What an effect, an element set or a solver keeps from one step to the next beside positions and
/// velocities, as numbers. They are read back in the order in which they were written. An archive
/// may come from a file that somebody else wrote: what is read as a number of things or as an index
/// is refused where it can be none.
class StateArchive {
 public:
  void write(double value) { values_.push_back(value); }
  /// The next number; NaN after the last one.
  double read();
  /// The next number, which has to be a whole one from `least` to `most`, both between ±2⁵³. Throws
  /// InputError.
  std::int64_t read_whole(std::int64_t least, std::int64_t most);
  /// Likewise, from 0 up to but not `size`.
  int read_index(std::int64_t size) { return static_cast<int>(read_whole(0, size - 1)); }
  /// Any int.
  int read_int();
  /// How many of something follow, of which each has at least `numbers` numbers in the archive.
  std::size_t read_count(std::size_t numbers = 1);
  /// Every coefficient of a dense matrix or vector, and back.
  template <class Matrix>
  void write_all(const Matrix& values) {
    for (Eigen::Index k = 0; k < values.size(); ++k) write(values.data()[k]);
  }
  template <class Matrix>
  void read_all(Matrix& values) {
    for (Eigen::Index k = 0; k < values.size(); ++k) values.data()[k] = read();
  }
  void rewind() { next_ = 0; }
  /// Empty again; its memory stays.
  void clear() {
    values_.clear();
    next_ = 0;
  }
  std::size_t size() const { return values_.size(); }
  std::size_t left() const { return values_.size() - next_; }  ///< that are to be read yet

 private:
  std::vector<double> values_;
  std::size_t next_ = 0;
};

}  // namespace pliant
