#pragma once

#include "cuda/core/vector.h"
#include "cuda/elements/sliced_rows.h"
#include "pliant/math/rotation.h"

/// Shape matching of clusters as ClusterSet does it (src/pliant/elements), in single precision: a
/// fit finds a cluster's rigid motion from its members, then each particle gathers what its
/// clusters pull it by.
namespace pliant {

/// Where a cluster is, side by side for those who gather it.
struct ClusterMotion {
  Fixed frame;      ///< rest of its origin, and the rest quantum [m]
  Fixed center;     ///< to where the fit moves that, and k [1/s²]
  Float4 rotation;  ///< a quaternion x, y, z, w; zero begins as the identity
};

/// Clusters in the memory of an executor. Those of many members are summed in chunks of them.
struct ClustersView {
  static constexpr int kUnroll = 4;  ///< lengths of rows are multiples of it
  static constexpr int kSpin = 9;    ///< numbers of a cluster in `spins`
  int clusters = 0;                  ///< 0: none
  int small = 0;  ///< so many, the first ones, are one chunk each, of their own number
  int chunks = 0;
  /// Members of chunks in slices (SlicedRowsLayout, as if chunks were particles): places, or ~place
  /// of one that weighs nothing.
  const int* begins = nullptr;
  const int* members = nullptr;
  const int* origins = nullptr;  ///< of chunks: the cluster's member that sums are measured from
  const int* owners = nullptr;   ///< of chunks: their clusters
  const int* first_chunks = nullptr;  ///< of clusters that are not small, and the end
  float* sums = nullptr;              ///< ClusterSums of the chunks of these
  // Where members rest: each in its cluster's frame (q [m], m [kg]), as `members`; or, where these
  // are null, all in one: of places [rest quanta], and their masses.
  const Float4* loads = nullptr;
  const Fixed* rest = nullptr;
  // Of clusters.
  const float* stiffness = nullptr;  ///< [1/s²]
  const float* spins = nullptr;  ///< Σ w O D of its particles, row by row [kg m²]; null: none turn
  ClusterMotion* motions = nullptr;
  // Of places, in slices: their clusters, or ~0; and where `loads` are not null q and m in each.
  const int* pull_begins = nullptr;
  const int* pull_clusters = nullptr;
  const Float4* pull_loads = nullptr;
};

/// Sums over members, about the origin: Σ m, Σ m x, Σ m q, Σ m x qᵀ row by row.
template <class T>
struct ClusterSums {
  static constexpr int kSize = 16;
  T v[kSize] = {};

  PLIANT_HOST_DEVICE void add(float mass, Float3 x, Float3 q) {
    const Float3 mx = mass * x;
    const float terms[kSize] = {mass,       mx.x,       mx.y,       mx.z,
                                mass * q.x, mass * q.y, mass * q.z, mx.x * q.x,
                                mx.x * q.y, mx.x * q.z, mx.y * q.x, mx.y * q.y,
                                mx.y * q.z, mx.z * q.x, mx.z * q.y, mx.z * q.z};
    for (int k = 0; k < kSize; ++k) v[k] += terms[k];
  }
};

/// Of a chunk's members at `x` [quanta].
PLIANT_HOST_DEVICE inline ClusterSums<float> sum_members(const ClustersView& c, const Fixed* x,
                                                         int chunk, float quantum) {
  ClusterSums<float> sums;
  constexpr int kSlice = SlicedRowsLayout::kSlice, kUnroll = ClustersView::kUnroll;
  const int origin = c.origins[chunk];
  const Fixed at = x[origin];
  const Fixed frame = c.motions[c.owners[chunk]].frame;
  const int end = sliced_end(c.begins, chunk);
  for (int k = sliced(c.begins, chunk); k < end; k += kUnroll * kSlice) {
    Float3 offset[kUnroll], q[kUnroll];
    float mass[kUnroll];
    for (int u = 0; u < kUnroll; ++u) {
      const int entry = c.members[k + kSlice * u];
      const int i = entry < 0 ? ~entry : entry;
      offset[u] = quantum * (x[i] - at);
      if (c.loads != nullptr) {
        const Float4 load = c.loads[k + kSlice * u];
        q[u] = load.xyz();
        mass[u] = load.w;
      } else {
        const Fixed rest = c.rest[i];
        q[u] = frame.w * (rest - frame);
        mass[u] = entry < 0 ? 0.0f : rest.w;
      }
    }
    for (int u = 0; u < kUnroll; ++u) sums.add(mass[u], offset[u], q[u]);
  }
  return sums;
}

/// The rigid motion that fits best: R nearest to A = Σ m (x − x_cm) (q − q_cm)ᵀ and the particles'
/// own Σ w O D, and the frame's origin moves to x_cm − R q_cm.
template <class T>
PLIANT_HOST_DEVICE inline void fit_cluster(const ClustersView& c, const Fixed* x, int origin,
                                           int cluster, float quantum, const ClusterSums<T>& sums) {
  const T* s = sums.v;
  const bool holds = s[0] > T(0);
  const T inverse = holds ? T(1) / s[0] : T(0);
  const T center[3] = {inverse * s[1], inverse * s[2], inverse * s[3]};
  const T middle[3] = {inverse * s[4], inverse * s[5], inverse * s[6]};
  Matrix3<float> moment;
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) {
      moment(r, k) = static_cast<float>(s[7 + 3 * r + k] - s[0] * center[r] * middle[k]);
      if (c.spins != nullptr) moment(r, k) += c.spins[ClustersView::kSpin * cluster + 3 * r + k];
    }
  }
  ClusterMotion& motion = c.motions[cluster];
  const Float4 last = motion.rotation;
  const Quaternion<float> rotation =
      nearest_rotation(moment, Quaternion<float>{last.w, last.x, last.y, last.z});
  motion.rotation = {rotation.x, rotation.y, rotation.z, rotation.w};
  const Matrix3<float> r = to_matrix(rotation);
  float offset[3];
  for (int k = 0; k < 3; ++k) {
    offset[k] = static_cast<float>(
                    center[k] - (r(k, 0) * middle[0] + r(k, 1) * middle[1] + r(k, 2) * middle[2])) /
                quantum;
  }
  Fixed to = moved(x[origin], {offset[0], offset[1], offset[2]});
  to.w = holds ? c.stiffness[cluster] : 0.0f;
  motion.center = to;
}

/// Of place i at `at`: Σ k m (c + R q − x) over its clusters [N].
PLIANT_HOST_DEVICE inline Float3 pull_of_clusters(const ClustersView& c, const Fixed& at, int i,
                                                  float quantum) {
  Float3 f = {0.0f, 0.0f, 0.0f};
  constexpr int kSlice = SlicedRowsLayout::kSlice, kUnroll = ClustersView::kUnroll;
  const Fixed rest = c.loads == nullptr ? c.rest[i] : Fixed{0, 0, 0, 0.0f};
  const int end = sliced_end(c.pull_begins, i);
  for (int k = sliced(c.pull_begins, i); k < end; k += kUnroll * kSlice) {
    ClusterMotion motion[kUnroll];
    Float4 load[kUnroll];  // q and m
    for (int u = 0; u < kUnroll; ++u) {
      const int entry = c.pull_clusters[k + kSlice * u];
      motion[u] = c.motions[entry < 0 ? ~entry : entry];
      if (c.loads != nullptr) {
        load[u] = c.pull_loads[k + kSlice * u];
      } else {
        const Fixed& frame = motion[u].frame;
        load[u] = with_w(frame.w * (rest - frame), entry < 0 ? 0.0f : rest.w);
      }
    }
    for (int u = 0; u < kUnroll; ++u) {
      if (load[u].w == 0.0f)
        continue;  // fills a row up, with a cluster that may be another scene's
      // R q = q + 2 v × (v × q + w q), v the quaternion's vector.
      const Float3 q = load[u].xyz(), v = motion[u].rotation.xyz();
      const Float3 turned = q + 2.0f * cross(v, cross(v, q) + motion[u].rotation.w * q);
      f += (motion[u].center.w * load[u].w) * (quantum * (motion[u].center - at) + turned);
    }
  }
  return f;
}

}  // namespace pliant
