#include "pliant/elements/cloth/bending_sums.h"

#include <cstddef>

#include "pliant/elements/cloth/coordinate_register.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

template <int R>
inline __attribute__((always_inline)) double sum_up(const BendingStencils& s,
                                                    const double* positions, int begin, int end) {
  double energy = 0.0;
  for (int e = begin; e < end; ++e) {
    const int first = s.firsts[static_cast<std::size_t>(e)];
    const int count = s.firsts[static_cast<std::size_t>(e) + 1] - first;
    const int* vertices = s.vertices.data() + first;
    const double* weights = s.weights.data() + static_cast<std::ptrdiff_t>(R) * first;
    // Of differences, so that a body far from the origin keeps its digits.
    Coordinates origin, curvature[R] = {};
    load(positions + 3 * static_cast<std::ptrdiff_t>(vertices[0]), origin);
    for (int k = 1; k < count; ++k) {
      Coordinates at;
      load(positions + 3 * static_cast<std::ptrdiff_t>(vertices[k]), at);
      const Coordinates apart = at - origin;
      for (int r = 0; r < R; ++r) curvature[r] += weights[R * k + r] * apart;
    }
    double squared = 0.0;
    for (int r = 0; r < R; ++r) {
      const Coordinates squares = curvature[r] * curvature[r];
      squared += squares[0] + squares[1] + squares[2];
    }
    energy += 0.5 * squared;
  }
  return energy;
}

PLIANT_WIDEST double energy_of_lines(const BendingStencils& s, const double* positions, int begin,
                                     int end) {
  return sum_up<1>(s, positions, begin, end);
}
PLIANT_WIDEST double energy_of_plates(const BendingStencils& s, const double* positions, int begin,
                                      int end) {
  return sum_up<3>(s, positions, begin, end);
}

PLIANT_WIDEST void add_forces_of(const int* begins, const int* columns, const double* values,
                                 const double* positions, int begin, int end, double* forces) {
  for (int i = begin; i < end; ++i) {
    Coordinates own, force = {}, sum;
    load(positions + 3 * static_cast<std::ptrdiff_t>(i), own);
    for (int k = begins[i]; k < begins[i + 1]; ++k) {
      Coordinates other;
      load(positions + 3 * static_cast<std::ptrdiff_t>(columns[k]), other);
      force += values[k] * (other - own);
    }
    double* to = forces + 3 * static_cast<std::ptrdiff_t>(i);
    load(to, sum);
    store(sum + force, to);
  }
}

}  // namespace

double bending_energy(const BendingStencils& stencils, const double* positions, int begin,
                      int end) {
  return stencils.rows == 1 ? energy_of_lines(stencils, positions, begin, end)
                            : energy_of_plates(stencils, positions, begin, end);
}

void add_bending_forces(const BendingRows& rows, const double* positions, int begin, int end,
                        double* forces) {
  add_forces_of(rows.begins.data(), rows.columns.data(), rows.values.data(), positions, begin, end,
                forces);
}

}  // namespace pliant
