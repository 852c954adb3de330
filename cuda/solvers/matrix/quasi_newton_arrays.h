#pragma once

#include "cuda/solvers/matrix/quasi_newton_direction.h"
#include "cuda/solvers/matrix/quasi_newton_step.h"

namespace pliant {

/// What L-BFGS keeps in the memory of an executor.
template <class Executor>
class QuasiNewtonArrays {
 public:
  void bind(const PackedMatrix& matrix, int particles, int blocks, int scenes) {
    if (matrix.kind != DeviceIteration::kQuasiNewton) return;
    view_.history = matrix.history;
    view_.sweeps = matrix.sweeps;
    view_.places = particles;
    const auto n = static_cast<std::size_t>(particles);
    const auto slots = static_cast<std::size_t>(view_.slots());
    for (int k = 0; k < 2; ++k) {
      view_.forces[k] = of(forces_[k], n);
      view_.found[k] = of(found_[k], n);
    }
    view_.wanted = of(wanted_, n);
    view_.holds = of(holds_, n);
    view_.s = of(s_, slots * n);
    view_.y = of(y_, slots * n);
    const int numbers = PairProducts::count(view_.slots());
    view_.partial = of(partial_, static_cast<std::size_t>(blocks * numbers));
    view_.states = of(states_, static_cast<std::size_t>(scenes));
  }
  const QuasiNewtonView& view() const { return view_; }

 private:
  template <class T>
  using Array = typename Executor::template Array<T>;

  template <class T>
  static T* of(Array<T>& array, std::size_t size) {
    array.resize(size);
    return array.data();
  }

  QuasiNewtonView view_;
  Array<Float4> forces_[2], found_[2], wanted_, holds_, s_, y_;
  Array<float> partial_;
  Array<QuasiNewtonState> states_;
};

}  // namespace pliant
