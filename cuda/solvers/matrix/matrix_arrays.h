#pragma once

#include <utility>
#include <vector>

#include "cuda/core/upload.h"
#include "cuda/solvers/gradient_step.h"
#include "cuda/solvers/matrix/packed_matrix.h"

namespace pliant {

/// A packed matrix in the memory of an executor.
template <class Executor>
class MatrixArrays {
 public:
  /// `particles` and `blocks` of the packed system.
  void bind(Executor& executor, const PackedMatrix& matrix, int particles, int blocks) {
    kind_ = matrix.kind;
    if (kind_ == DeviceIteration::kJacobi) return;
    if (!matrix.rows.empty()) {
      view_.rows.begins = put(executor, begins_, matrix.rows.begins);
      view_.rows.neighbors = put(executor, neighbors_, matrix.rows.neighbors);
      view_.rows.b = put(executor, values_, matrix.rows.b);
    }
    if (!matrix.held.empty()) view_.held = put(executor, held_, matrix.held);
    if (kind_ == DeviceIteration::kQuasiNewton) return;  // QuasiNewtonArrays has the rest
    correction_.resize(static_cast<std::size_t>(particles));
    view_.correction = correction_.data();
    if (kind_ == DeviceIteration::kLineSearch) {
      lengths_.resize(static_cast<std::size_t>(blocks));
      products_.resize(2 * static_cast<std::size_t>(blocks));
      view_.lengths = lengths_.data();
      view_.products = products_.data();
      return;
    }
    view_.overflow_sums = put(executor, sums_, matrix.overflow_sums);
    view_.members = put(executor, members_, matrix.members);
    level_begins_ = matrix.level_begins;
  }

  DeviceIteration::Kind kind() const { return kind_; }
  const MatrixView& view() const { return view_; }
  /// Calls use(first, count) for the rows of each level of a sweep in turn.
  template <class Use>
  void for_each_level(const Use& use) const {
    if (view_.rows.begins == nullptr) return;  // what ties nobody has one colour
    for (std::size_t level = 0; level + 1 < level_begins_.size(); ++level) {
      use(level_begins_[level], level_begins_[level + 1] - level_begins_[level]);
    }
  }

 private:
  template <class T>
  using Array = typename Executor::template Array<T>;

  template <class T>
  static const T* put(Executor& executor, Array<T>& array, const std::vector<T>& values) {
    upload_all(executor, array, values);
    return array.data();
  }

  DeviceIteration::Kind kind_ = DeviceIteration::kJacobi;
  MatrixView view_;
  std::vector<int> level_begins_;
  Array<int> begins_, neighbors_, members_;
  Array<float> values_, held_, sums_, lengths_, products_;
  Array<Float4> correction_;
};

}  // namespace pliant
