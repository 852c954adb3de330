#include "pliant/elements/cloth/bending_relaxation.h"

#include "pliant/elements/cloth/coordinate_register.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

/// L D Lᵀ x = b in place.
template <int R>
inline void solve(const double* a, Coordinates (&b)[R]) {
  for (int r = 1; r < R; ++r) {
    for (int k = 0; k < r; ++k) b[r] -= a[row_of(r) + k] * b[k];
  }
  for (int r = 0; r < R; ++r) b[r] *= a[row_of(r) + r];
  for (int r = R - 2; r >= 0; --r) {
    for (int k = r + 1; k < R; ++k) b[r] -= a[row_of(k) + r] * b[k];
  }
}

template <int R>
inline __attribute__((always_inline)) void relax_range(const BendingRelaxation& all, int begin,
                                                       int end) {
  const BendingStencils& s = all.stencils;
  for (int e = begin; e < end; ++e) {
    const int first = s.firsts[static_cast<std::size_t>(e)];
    const int count = s.firsts[static_cast<std::size_t>(e) + 1] - first;
    const int* vertices = s.vertices.data() + first;
    const double* weights = s.weights.data() + static_cast<std::ptrdiff_t>(R) * first;
    double* lambda = all.multipliers + static_cast<std::ptrdiff_t>(3 * R) * e;
    // Of differences, so that a body far from the origin keeps its digits.
    Coordinates origin, kept[R] = {}, delta[R] = {};
    load(all.positions + 3 * static_cast<std::ptrdiff_t>(vertices[0]), origin);
    for (int k = 1; k < count; ++k) {
      Coordinates at;
      load(all.positions + 3 * static_cast<std::ptrdiff_t>(vertices[k]), at);
      const Coordinates apart = at - origin;
      for (int r = 0; r < R; ++r) delta[r] += weights[R * k + r] * apart;
    }
    for (int r = 0; r < R; ++r) {
      load(lambda + 3 * r, kept[r]);
      delta[r] = -(delta[r] + kept[r]);
    }
    solve<R>(all.factors + static_cast<std::ptrdiff_t>(row_of(R)) * e, delta);
    for (int r = 0; r < R; ++r) store(kept[r] + delta[r], lambda + 3 * r);
    for (int k = 0; k < count; ++k) {
      const double own = all.dt2 * all.mobility[vertices[k]];
      double* place = all.positions + 3 * static_cast<std::ptrdiff_t>(vertices[k]);
      Coordinates at, sum = weights[R * k] * delta[0];
      load(place, at);
      for (int r = 1; r < R; ++r) sum += weights[R * k + r] * delta[r];
      store(at + own * sum, place);
    }
  }
}

PLIANT_WIDEST void relax_lines(const BendingRelaxation& all, int begin, int end) {
  relax_range<1>(all, begin, end);
}
PLIANT_WIDEST void relax_plates(const BendingRelaxation& all, int begin, int end) {
  relax_range<3>(all, begin, end);
}

}  // namespace

void BendingRelaxation::relax(int begin, int end) const {
  if (stencils.rows == 1) {
    relax_lines(*this, begin, end);
  } else {
    relax_plates(*this, begin, end);
  }
}

}  // namespace pliant
