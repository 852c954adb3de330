#include "pliant/math/rotation_batch.h"

#include "pliant/math/rotation.h"
#include "pliant/math/widest.h"

// A loop only vectorises with everything inlined that it calls.
#define PLIANT_FLATTEN __attribute__((flatten))

namespace pliant {
namespace {

using namespace rotation_detail;

/// Matrices worked on together: whole vector registers of 4, 8 or 16 entries, few enough for the
/// first-level cache.
constexpr int kLanes = 16;

/// Lane l of component k is x[k][l]. Every loop over lanes is one that the compiler vectorises.
template <typename T>
struct Block {
  T f[9][kLanes];  // scaled
  T q[4][kLanes];  // where the search starts, then the result
  T frame[9][kLanes];
  T delta[kLanes];
  T y[3][kLanes];
  T running[kLanes];  // 1 or 0
  T failed[kLanes];   // 1 or 0
};

template <typename T>
inline Matrix3<T> matrix(const T (&m)[9][kLanes], int l) {
  return {{m[0][l], m[1][l], m[2][l], m[3][l], m[4][l], m[5][l], m[6][l], m[7][l], m[8][l]}};
}

template <typename T>
inline Quaternion<T> quaternion(const T (&q)[4][kLanes], int l) {
  return {q[0][l], q[1][l], q[2][l], q[3][l]};
}

template <typename T>
inline void set(T (&to)[4][kLanes], int l, const Quaternion<T>& q) {
  to[0][l] = q.w;
  to[1][l] = q.x;
  to[2][l] = q.y;
  to[3][l] = q.z;
}

template <typename T>
PLIANT_FLATTEN void load(const Matrix3<T>* f, Block<T>& b) {
  for (int l = 0; l < kLanes; ++l) {
    for (int k = 0; k < 9; ++k) b.f[k][l] = f[l].m[k];
  }
  for (int l = 0; l < kLanes; ++l) {
    const Matrix3<T> g = scaled(matrix(b.f, l));
    for (int k = 0; k < 9; ++k) b.f[k][l] = g.m[k];
  }
}

template <typename T>
PLIANT_FLATTEN void start_lanes(Block<T>& b) {
  for (int l = 0; l < kLanes; ++l) set(b.q, l, cold_start(matrix(b.f, l)));
}

template <typename T>
PLIANT_FLATTEN void make_frames(Block<T>& b) {
  for (int l = 0; l < kLanes; ++l) {
    const Frame<T> f = make_frame(transpose_times(to_matrix(quaternion(b.q, l)), matrix(b.f, l)));
    b.frame[0][l] = f.a0;
    b.frame[1][l] = f.a1;
    b.frame[2][l] = f.a2;
    b.frame[3][l] = f.b00;
    b.frame[4][l] = f.b11;
    b.frame[5][l] = f.b22;
    b.frame[6][l] = f.b01;
    b.frame[7][l] = f.b02;
    b.frame[8][l] = f.b12;
    b.delta[l] = T(0);
    b.running[l] = T(1);
    b.failed[l] = T(0);
  }
}

/// One pass of the loop in `refine`. A lane that is done keeps its δ, and so finds its y again.
template <typename T>
PLIANT_FLATTEN void solve(Block<T>& b) {
  for (int l = 0; l < kLanes; ++l) {
    const Frame<T> f{b.frame[0][l], b.frame[1][l], b.frame[2][l], b.frame[3][l], b.frame[4][l],
                     b.frame[5][l], b.frame[6][l], b.frame[7][l], b.frame[8][l]};
    const Root<T> root = solve_secular(f, b.delta[l]);
    const bool running = root.certain & !root.converged;
    b.delta[l] += running ? root.increment : T(0);
    b.running[l] = running ? T(1) : T(0);
    b.failed[l] = (root.certain & root.accurate) ? T(0) : T(1);
    b.y[0][l] = root.y0;
    b.y[1][l] = root.y1;
    b.y[2][l] = root.y2;
  }
}

template <typename T>
inline bool any_running(const Block<T>& b) {
  T sum = T(0);
  for (int l = 0; l < kLanes; ++l) sum += b.running[l];
  return sum > T(0);
}

/// `refine` for every lane, from b.q.
template <typename T>
PLIANT_FLATTEN void refine_lanes(Block<T>& b) {
  make_frames(b);
  for (int k = 0; k < kMaxSolves && any_running(b); ++k) solve(b);
  for (int l = 0; l < kLanes; ++l) {
    set(b.q, l,
        normalised(quaternion(b.q, l) * Quaternion<T>{T(1), b.y[0][l], b.y[1][l], b.y[2][l]}));
  }
}

template <typename T>
inline bool succeeded(const Block<T>& b, int l) {
  return b.failed[l] == T(0) && b.running[l] == T(0);
}

// Rare and long: not in the midst of a loop over lanes.
template <typename T>
__attribute__((noinline)) Quaternion<T> alone(const Matrix3<T>& f) {
  return nearest_rotation(f);
}
template <typename T>
__attribute__((noinline)) Quaternion<T> alone(const Matrix3<T>& f, const Quaternion<T>& q) {
  return nearest_rotation(f, q);
}

template <typename T>
inline void warm_block(const Matrix3<T>* f, Quaternion<T>* q) {
  Block<T> b;
  load(f, b);
  for (int l = 0; l < kLanes; ++l) set(b.q, l, q[l]);
  refine_lanes(b);
  for (int l = 0; l < kLanes; ++l) {
    const bool usable = succeeded(b, l) && about_unit(q[l]);
    q[l] = usable ? on_side_of(quaternion(b.q, l), q[l]) : alone(f[l], q[l]);
  }
}

template <typename T>
inline void cold_block(const Matrix3<T>* f, Quaternion<T>* q) {
  Block<T> b;
  load(f, b);
  start_lanes(b);
  refine_lanes(b);
  for (int l = 0; l < kLanes; ++l) {
    q[l] =
        succeeded(b, l) ? on_side_of(quaternion(b.q, l), Quaternion<T>::identity()) : alone(f[l]);
  }
}

/// A whole block takes less time than this many matrices one by one.
constexpr int kWorthABlock = 4;

/// The first `count` matrices, and identities in the lanes behind them, which are done at once.
template <typename T>
struct Remainder {
  Remainder(const Matrix3<T>* from, const Quaternion<T>* start, int count) {
    for (int l = 0; l < kLanes; ++l) {
      f[l] = l < count ? from[l] : Matrix3<T>{{T(1), 0, 0, 0, T(1), 0, 0, 0, T(1)}};
      q[l] = l < count ? start[l] : Quaternion<T>::identity();
    }
  }
  Matrix3<T> f[kLanes];
  Quaternion<T> q[kLanes];
};

template <typename T>
inline void warm_all(const Matrix3<T>* f, Quaternion<T>* q, int count) {
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) warm_block(f + i, q + i);
  if (count - i >= kWorthABlock) {
    Remainder<T> rest(f + i, q + i, count - i);
    warm_block(rest.f, rest.q);
    for (int l = 0; i < count; ++i, ++l) q[i] = rest.q[l];
  }
  for (; i < count; ++i) q[i] = alone(f[i], q[i]);
}

template <typename T>
inline void cold_all(const Matrix3<T>* f, Quaternion<T>* q, int count) {
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) cold_block(f + i, q + i);
  if (count - i >= kWorthABlock) {
    Remainder<T> rest(f + i, q + i, count - i);
    cold_block(rest.f, rest.q);
    for (int l = 0; i < count; ++i, ++l) q[i] = rest.q[l];
  }
  for (; i < count; ++i) q[i] = alone(f[i]);
}

// Flattened, so that all that they call is of their own width.
#define PLIANT_WIDE_LOOP PLIANT_WIDEST PLIANT_FLATTEN
PLIANT_WIDE_LOOP void warm(const Matrix3<float>* f, Quaternion<float>* q, int count) {
  warm_all(f, q, count);
}
PLIANT_WIDE_LOOP void warm(const Matrix3<double>* f, Quaternion<double>* q, int count) {
  warm_all(f, q, count);
}
PLIANT_WIDE_LOOP void cold(const Matrix3<float>* f, Quaternion<float>* q, int count) {
  cold_all(f, q, count);
}
PLIANT_WIDE_LOOP void cold(const Matrix3<double>* f, Quaternion<double>* q, int count) {
  cold_all(f, q, count);
}

}  // namespace

template <typename T>
void nearest_rotations(const Matrix3<T>* f, Quaternion<T>* q, int count) {
  warm(f, q, count);
}

template <typename T>
void nearest_rotations_cold(const Matrix3<T>* f, Quaternion<T>* q, int count) {
  cold(f, q, count);
}

template void nearest_rotations(const Matrix3<float>*, Quaternion<float>*, int);
template void nearest_rotations(const Matrix3<double>*, Quaternion<double>*, int);
template void nearest_rotations_cold(const Matrix3<float>*, Quaternion<float>*, int);
template void nearest_rotations_cold(const Matrix3<double>*, Quaternion<double>*, int);

}  // namespace pliant
