#pragma once

#include <cstddef>
#include <vector>

#include "cuda/core/upload.h"
#include "cuda/core/vector.h"
#include "pliant/core/body/embedded_points.h"

/// Points that particles carry, such as the surface of a patch, as core/body/embedded_points.h.
namespace pliant {

/// A position in whole quanta from the body's centre, as small as it can be sent.
struct Quanta3 {
  int x, y, z;
};

PLIANT_HOST_DEVICE inline Quanta3 quanta_of(const Fixed& x) { return {x.x, x.y, x.z}; }

/// Points that are particles.
struct PickPoints {
  const Fixed* x;
  const int* places;
  Quanta3* points;

  PLIANT_HOST_DEVICE void operator()(int i) const { points[i] = quanta_of(x[places[i]]); }
};

/// p = x_0 + Σ w_k (x_k - x_0), k = 1..3: differences of neighbours are exact, so that a point
/// keeps the digits that the particles have.
struct CarryPoints {
  const Fixed* x;
  const Int4* places;
  const Float4* weights;
  Quanta3* points;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const Int4 at = places[i];
    const Float4 w = weights[i];
    const Fixed first = x[at.v[0]];
    const Float3 offset =
        w.y * (x[at.v[1]] - first) + w.z * (x[at.v[2]] - first) + w.w * (x[at.v[3]] - first);
    points[i] = quanta_of(moved(first, offset));
  }
};

/// The points in the memory of an executor.
template <class Executor>
class DeviceEmbeddedPoints {
 public:
  template <class T>
  using Array = typename Executor::template Array<T>;
  template <class T>
  using Staged = typename Executor::template Staged<T>;

  /// Null: the particles themselves, in order. `place`: of each particle.
  void bind(Executor& executor, const EmbeddedPoints* points, const std::vector<int>& place) {
    if (is_bound_ && bound_ == points) return;
    if (points != nullptr) {
      bind_carried(executor, *points, place);
      count_ = static_cast<std::size_t>(points->size());
    } else {
      upload_all(executor, picked_, place);
      count_ = place.size();
    }
    if (points_.size() < count_) points_.resize(count_);
    executor.synchronize();  // what was uploaded may go
    bound_ = points;
    is_bound_ = true;
  }
  /// Where they are, of particles at `x` [quanta]; Executor::finish_downloads() ends it.
  void begin_download(Executor& executor, const Fixed* x, Staged<Quanta3>& to) {
    const int count = static_cast<int>(count_);
    if (bound_ != nullptr) {
      executor.launch(count, CarryPoints{x, places_.data(), weights_.data(), points_.data()});
    } else {
      executor.launch(count, PickPoints{x, picked_.data(), points_.data()});
    }
    to.resize(count_);
    executor.begin_download(to.data(), points_, count_);
  }

 private:
  void bind_carried(Executor& executor, const EmbeddedPoints& points,
                    const std::vector<int>& place) {
    std::vector<Int4> places;
    std::vector<Float4> weights;
    for (int i = 0; i < points.size(); ++i) {
      const auto particles = points.particles().col(i);
      const Eigen::Vector4f w = points.weights().col(i).cast<float>();
      Int4 own;
      for (int k = 0; k < 4; ++k) own.v[k] = place[static_cast<std::size_t>(particles[k])];
      places.push_back(own);
      weights.push_back({w[0], w[1], w[2], w[3]});
    }
    upload_all(executor, places_, places);
    upload_all(executor, weights_, weights);
    executor.synchronize();
  }

  bool is_bound_ = false;
  const EmbeddedPoints* bound_ = nullptr;
  std::size_t count_ = 0;
  Array<int> picked_;
  Array<Int4> places_;
  Array<Float4> weights_;
  Array<Quanta3> points_;
};

}  // namespace pliant
