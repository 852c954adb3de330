#include "pliant/models/reduced/polynomial_kernel.h"

// One source for several widths of registers; the program takes the widest at start-up.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PLIANT_WIDEST __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define PLIANT_WIDEST
#endif

namespace pliant {
namespace {

__attribute__((always_inline)) inline double sum_of(const Lanes& a) {
  return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

}  // namespace

PLIANT_WIDEST
void contract(const CoefficientRows& c, const double* weights, const Lanes* s, Lanes* sum,
              double* dots) {
  const int lanes = c.lanes;
  const Lanes* row = c.begin;
  int k = 0;
  for (; k + 4 <= c.rows; k += 4, row += 4 * lanes) {
    const Lanes *c0 = row, *c1 = c0 + lanes, *c2 = c1 + lanes, *c3 = c2 + lanes;
    const double w0 = weights[k], w1 = weights[k + 1], w2 = weights[k + 2], w3 = weights[k + 3];
    Lanes d0{}, d1{}, d2{}, d3{};
    for (int p = 0; p < lanes; ++p) {
      const Lanes x = s[p];
      d0 += c0[p] * x;
      d1 += c1[p] * x;
      d2 += c2[p] * x;
      d3 += c3[p] * x;
      sum[p] += (w0 * c0[p] + w1 * c1[p]) + (w2 * c2[p] + w3 * c3[p]);
    }
    dots[k] = sum_of(d0);
    dots[k + 1] = sum_of(d1);
    dots[k + 2] = sum_of(d2);
    dots[k + 3] = sum_of(d3);
  }
  for (; k < c.rows; ++k, row += lanes) {
    Lanes d{};
    for (int p = 0; p < lanes; ++p) {
      d += row[p] * s[p];
      sum[p] += weights[k] * row[p];
    }
    dots[k] = sum_of(d);
  }
}

PLIANT_WIDEST
void contract_and_spread(const CoefficientRows& c, const double* weights, double scale,
                         const Lanes* s, Lanes* sum, Lanes* targets, std::ptrdiff_t stride,
                         double* dots) {
  const int lanes = c.lanes;
  const Lanes* row = c.begin;
  int k = 0;
  for (; k + 2 <= c.rows; k += 2, row += 2 * lanes, targets += 2 * stride) {
    const Lanes *c0 = row, *c1 = row + lanes;
    Lanes *t0 = targets, *t1 = targets + stride;
    const double w0 = weights[k], w1 = weights[k + 1];
    Lanes d0{}, d1{};
    for (int p = 0; p < lanes; ++p) {
      const Lanes x = s[p], a = c0[p], b = c1[p];
      d0 += a * x;
      d1 += b * x;
      t0[p] += scale * a;
      t1[p] += scale * b;
      sum[p] += w0 * a + w1 * b;
    }
    dots[k] = sum_of(d0);
    dots[k + 1] = sum_of(d1);
  }
  for (; k < c.rows; ++k, row += lanes, targets += stride) {
    Lanes d{};
    for (int p = 0; p < lanes; ++p) {
      d += row[p] * s[p];
      targets[p] += scale * row[p];
      sum[p] += weights[k] * row[p];
    }
    dots[k] = sum_of(d);
  }
}

PLIANT_WIDEST
double sum_lanes(const Lanes* lanes, std::size_t count) {
  Lanes a{}, b{}, c{}, d{};
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) {
    a += lanes[k];
    b += lanes[k + 1];
    c += lanes[k + 2];
    d += lanes[k + 3];
  }
  for (; k < count; ++k) a += lanes[k];
  const Lanes sum = (a + b) + (c + d);
  return sum_of(sum);
}

}  // namespace pliant
