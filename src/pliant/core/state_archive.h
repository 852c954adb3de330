#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace pliant {

/// What an effect, an element set or a solver keeps from one step to the next beside positions and
/// velocities, as numbers. They are read back in the order in which they were written.
class StateArchive {
 public:
  void write(double value) { values_.push_back(value); }
  /// The next number; NaN after the last one.
  double read();
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

 private:
  std::vector<double> values_;
  std::size_t next_ = 0;
};

}  // namespace pliant
