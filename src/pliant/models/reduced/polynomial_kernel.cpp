#include "pliant/models/reduced/polynomial_kernel.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "pliant/math/widest.h"

#define PLIANT_INLINE __attribute__((always_inline)) inline

namespace pliant {
namespace {

using Quad __attribute__((vector_size(32))) = double;
using Pair __attribute__((vector_size(16))) = double;

PLIANT_INLINE Lanes load(const double* from) {
  Lanes a;
  std::memcpy(&a, from, sizeof a);
  return a;
}

PLIANT_INLINE void store(const Lanes& a, double* to) { std::memcpy(to, &a, sizeof a); }

// The numbers of two, one after the other, that have those places. Compilers name it differently.
#if defined(__clang__)
#define PLIANT_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
using Order __attribute__((vector_size(32))) = std::int64_t;
#define PLIANT_SHUFFLE(a, b, ...) __builtin_shuffle(a, b, Order{__VA_ARGS__})
#endif

/// a0 + a4, a1 + a5, a2 + a6, a3 + a7.
PLIANT_INLINE Quad fold(const Lanes& a) {
  Quad half[2];
  std::memcpy(half, &a, sizeof a);
  return half[0] + half[1];
}

PLIANT_INLINE double sum_of(const Lanes& a) {
  const Quad quad = fold(a);
  Pair half[2];
  std::memcpy(half, &quad, sizeof quad);
  const Pair pair = half[0] + half[1];
  return pair[0] + pair[1];
}

/// sum_of() of four at once, to `to`.
PLIANT_INLINE void sums_of(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d,
                           double* to) {
  const Quad qa = fold(a), qb = fold(b), qc = fold(c), qd = fold(d);
  const Quad ac = PLIANT_SHUFFLE(qa, qc, 0, 1, 4, 5) + PLIANT_SHUFFLE(qa, qc, 2, 3, 6, 7);
  const Quad bd = PLIANT_SHUFFLE(qb, qd, 0, 1, 4, 5) + PLIANT_SHUFFLE(qb, qd, 2, 3, 6, 7);
  const Quad sums = PLIANT_SHUFFLE(ac, bd, 0, 4, 2, 6) + PLIANT_SHUFFLE(ac, bd, 1, 5, 3, 7);
  std::memcpy(to, &sums, sizeof sums);
}

PLIANT_INLINE void contract_rows(const CoefficientRows& c, const double* weights, const Lanes* s,
                                 Lanes* sum, double* dots) {
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
    sums_of(d0, d1, d2, d3, dots + k);
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

/// to[k] = the sum of lanes[k]; `lanes` and `to` have room for a multiple of four.
PLIANT_INLINE void sums_of_all(const Lanes* lanes, int count, double* to) {
  for (int k = 0; k < count; k += 4) {
    sums_of(lanes[k], lanes[k + 1], lanes[k + 2], lanes[k + 3], to + k);
  }
}

}  // namespace

PLIANT_WIDEST
void contract(const CoefficientRows& c, const double* weights, const Lanes* s, Lanes* sum,
              double* dots) {
  contract_rows(c, weights, s, sum, dots);
}

PLIANT_WIDEST
double add_force(const Lanes* blocks, int rank, const double* q, double* r, ForceSpace& space) {
  const int pair_lanes = lanes_for(rank * (rank + 1) / 2);
  const auto room = static_cast<std::size_t>(pair_lanes) + 1;
  if (space.s.size() < room) {
    space.s.resize(room);
    space.sum.resize(room);
  }
  std::fill(space.s.begin() + pair_lanes - 1, space.s.begin() + pair_lanes + 1, Lanes{});
  std::fill(space.sum.begin(), space.sum.begin() + pair_lanes + 1, Lanes{});
  double* s = reinterpret_cast<double*>(space.s.data());
  // Whole lanes: what lies beyond a column is the next one's, written later.
  for (int j = 0; j < rank; s += ++j) {
    for (int i = 0; i <= j; i += kLanes) store(load(q + i) * q[j], s + i);
  }
  Lanes own[kMaxRank + 4];  // of each k
  std::fill(own, own + rank + 4, Lanes{});
  double weights[kMaxRank + 2 * kLanes], dots[kMaxRank + 2 * kLanes], sums[kMaxRank + 4];
  for (int k = 0; k < rank; ++k) {
    const CoefficientRows rows{blocks, rank - k + 1, lanes_for((k + 1) * (k + 2) / 2)};
    blocks += rows.rows * rows.lanes;
    weights[0] = q[k];
    for (int l = k; l < rank; l += kLanes) store(q[k] * load(q + l), weights + l - k + 1);
    contract_rows(rows, weights, space.s.data(), space.sum.data(), dots);
    store(Lanes{}, dots + rows.rows);
    own[k] = Lanes{dots[0]};
    for (int l = k; l < rank; l += kLanes) {
      const Lanes dot = load(dots + l - k + 1);
      own[k] += load(q + l) * dot;
      store(load(r + l) + q[k] * dot, r + l);
    }
  }
  sums_of_all(own, rank, sums);
  double energy = 0.0;
  for (int k = 0; k < rank; ++k) {
    r[k] += sums[k];
    energy += q[k] * sums[k];
  }
  // r += Jᵀ g, J the derivative of the products s: each pair (i, j) gives g qⱼ to i and g qᵢ to j.
  using Index __attribute__((vector_size(64))) = std::int64_t;
  const Index first{0, 1, 2, 3, 4, 5, 6, 7};
  const double* g = reinterpret_cast<const double*>(space.sum.data());
  for (int j = 0; j < rank; g += ++j) {
    own[j] = Lanes{};
    for (int i = 0; i <= j; i += kLanes) {
      const Lanes in_column = first + i <= j ? load(g + i) : Lanes{};
      own[j] += in_column * load(q + i);
      store(load(r + i) + in_column * q[j], r + i);
    }
  }
  sums_of_all(own, rank, sums);
  for (int k = 0; k < rank; ++k) r[k] += sums[k];
  return energy;
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
