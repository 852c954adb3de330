#pragma once

#include <utility>
#include <vector>

#include "cuda/core/upload.h"
#include "cuda/solvers/matrix/multigrid_step.h"

namespace pliant {

/// The levels of a packed system's multigrid below the finest, in the memory of an executor.
template <class Executor>
class MultigridArrays {
 public:
  void bind(Executor& executor, const std::vector<SceneMultigrid>& scenes) {
    if (scenes.empty()) return;
    const MultigridPool pool = pool_of(scenes);
    view_.fine = fine_.bind(executor, pool.fine);
    view_.matrix = matrix_.bind(executor, pool.matrix);
    view_.restriction = restriction_.bind(executor, pool.restriction);
    view_.prolongation = prolongation_.bind(executor, pool.prolongation);
    view_.rule = put(executor, rule_, pool.rule);
    view_.diagonal = put(executor, diagonal_, pool.diagonal);
    view_.bottoms = put(executor, bottoms_, pool.bottoms);
    if (scenes.size() > 1) view_.scenes = put(executor, scenes_, pool.scene_of_slice);
    held_.resize(3 * pool.rule.size());
    view_.held = held_.data();
    q_.resize(pool.rule.size());
    view_.q = q_.data();
    for (int k = 0; k < 2; ++k) {
      z_[k].resize(pool.rule.size());
      view_.z[k] = z_[k].data();
    }
    level_begins_ = pool.level_begins;
    is_there_ = true;
  }

  bool is_there() const { return is_there_; }
  const CoarseView& view() const { return view_; }
  int launched_levels() const { return static_cast<int>(level_begins_.size()) - 1; }
  /// First row of a launched level, and how many it has.
  std::pair<int, int> rows(int level) const {
    const auto at = static_cast<std::size_t>(level);
    return {level_begins_[at], level_begins_[at + 1] - level_begins_[at]};
  }

 private:
  template <class T>
  using Array = typename Executor::template Array<T>;

  template <class T>
  static const T* put(Executor& executor, Array<T>& array, const std::vector<T>& values) {
    upload_all(executor, array, values);
    return array.data();
  }
  struct Rows {
    Array<int> begins, neighbors;
    Array<float> b;
    RowsView bind(Executor& executor, const SlicedRows& rows) {
      RowsView view;
      view.begins = put(executor, begins, rows.begins);
      view.neighbors = put(executor, neighbors, rows.neighbors);
      view.b = put(executor, b, rows.b);
      return view;
    }
  };

  CoarseView view_;
  bool is_there_ = false;
  std::vector<int> level_begins_;
  Rows fine_, matrix_, restriction_, prolongation_;
  Array<Float4> rule_, held_, q_, z_[2];
  Array<float> diagonal_;
  Array<int> scenes_;
  Array<CycleBottom> bottoms_;
};

}  // namespace pliant
