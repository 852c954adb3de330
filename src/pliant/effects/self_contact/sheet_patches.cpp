#include "pliant/effects/self_contact/sheet_patches.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {

// Vertices of a patch at most: the smaller, the less a neighbourhood bends; the larger, the fewer
// there are.
constexpr int kMostVertices = 12;
// Of the mean edge: pairs whose spheres are farther apart are taken to be as near as these.
constexpr double kExactWithin = 1.0;
// Of the mean edge: what rounding to single precision may change.
constexpr double kRoundOff = 1e-5;
// Patches that a thread surrounds at once.
constexpr int kGrain = 16;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

Double3 plain(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d vector(const Double3& v) { return {v.x, v.y, v.z}; }

Double3 middle_of(const std::vector<Double3>& x, const SheetMesh::Numbers& vertices) {
  Double3 sum = {0.0, 0.0, 0.0};
  for (const int i : vertices) sum += x[index(i)];
  return sum / static_cast<double>(vertices.end() - vertices.begin());
}

template <class A, class B>
bool share_a_vertex(const A& a, const B& b) {
  for (const int i : a) {
    for (const int j : b) {
      if (i == j) return true;
    }
  }
  return false;
}

}  // namespace

SheetMesh::Numbers SheetPatches::vertices(int patch) const {
  return {vertices_.data() + at(patch).vertices, vertices_.data() + at(patch + 1).vertices};
}

SheetMesh::Numbers SheetPatches::edges(int patch) const {
  return {edges_.data() + at(patch).edges, edges_.data() + at(patch + 1).edges};
}

void SheetPatches::cut(const SheetMesh& mesh) {
  vertices_.resize(mesh.rest.size());
  std::iota(vertices_.begin(), vertices_.end(), 0);
  std::stable_sort(vertices_.begin(), vertices_.end(),
                   [&](int a, int b) { return mesh.pieces[index(a)] < mesh.pieces[index(b)]; });
  const int count = mesh.vertices();
  for (int first = 0, last = 0; first < count; first = last) {
    const int piece = mesh.pieces[index(vertices_[index(first)])];
    while (last < count && mesh.pieces[index(vertices_[index(last)])] == piece) ++last;
    split(mesh, first, last - first);
  }
}

void SheetPatches::split(const SheetMesh& mesh, int first, int count) {
  const auto begin = vertices_.begin() + first;
  if (count <= kMostVertices) {
    std::sort(begin, begin + count);
    const int piece = mesh.pieces[index(vertices_[index(first)])];
    patches_.push_back({first, 0, 0, 0, piece, {0.0, 0.0, 0.0}, 0.0, {0.0, 0.0}});
    return;
  }
  Eigen::AlignedBox3d box;
  for (auto i = begin; i != begin + count; ++i) box.extend(vector(mesh.rest[index(*i)]));
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto place = [&](int i) { return std::make_pair(vector(mesh.rest[index(i)])[axis], i); };
  const int half = count / 2;
  std::nth_element(begin, begin + half, begin + count,
                   [&](int a, int b) { return place(a) < place(b); });
  split(mesh, first, half);
  split(mesh, first + half, count - half);
}

void SheetPatches::add_edges(const SheetMesh& mesh) {
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    patches_[p].edges = static_cast<int>(edges_.size());
    const int end =
        p + 1 < patches_.size() ? patches_[p + 1].vertices : static_cast<int>(vertices_.size());
    for (int k = patches_[p].vertices; k < end; ++k) {
      const int v = vertices_[index(k)];
      for (const int e : mesh.edges_of(v)) {
        if (mesh.edges(0, e) == v) edges_.push_back(e);
      }
    }
    std::sort(edges_.begin() + patches_[p].edges, edges_.end());
  }
}

/// What lies around one patch at rest.
class SheetPatches::Surroundings {
 public:
  Surroundings(const SheetMesh& mesh, const SheetPatches& all, double thickness)
      : mesh_(mesh), joints_(mesh.joints()), all_(all), thickness_(thickness) {}

  /// The patch knows its center and radius.
  void find(int patch, const BoxHierarchy& triangle_tree, const BoxHierarchy& edge_tree) {
    const Patch& own = all_.at(patch);
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(own.radius);
    const Eigen::AlignedBox3d box(vector(own.center) - reach, vector(own.center) + reach);
    std::vector<int> triangles, edges;
    triangle_tree.for_each_overlapping(box, [&](int t) {
      if (all_.is_around(patch, mesh_.triangles.col(t))) triangles.push_back(t);
    });
    edge_tree.for_each_overlapping(box, [&](int e) {
      if (all_.is_around(patch, mesh_.edges.col(e))) edges.push_back(e);
    });
    take_vertices(patch, triangles, edges);
    take_places(own);
    take_rooms(patch, triangles, edges);
  }

  int inner() const { return inner_; }
  const std::vector<Near>& around() const { return around_; }
  const double* spread() const { return spread_; }

 private:
  /// First those of own simplices, then the others, both ascending.
  void take_vertices(int patch, const std::vector<int>& triangles, const std::vector<int>& edges) {
    std::vector<int> inner(all_.vertices(patch).begin(), all_.vertices(patch).end());
    for (const int e : all_.edges(patch)) inner.push_back(mesh_.edges(1, e));
    sort_unique(inner);
    std::vector<int> others;
    for (const int t : triangles) {
      for (const int i : mesh_.triangles.col(t)) others.push_back(i);
    }
    for (const int e : edges) {
      for (const int i : mesh_.edges.col(e)) others.push_back(i);
    }
    sort_unique(others);
    inner_ = static_cast<int>(inner.size());
    around_.clear();
    for (const int i : inner) add(i);
    for (const int i : others) {
      if (!std::binary_search(inner.begin(), inner.end(), i)) add(i);
    }
  }
  static void sort_unique(std::vector<int>& numbers) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  }
  void add(int vertex) {
    around_.push_back({vertex, {0.0f, 0.0f}, std::numeric_limits<float>::infinity()});
  }

  void take_places(const Patch& own) {
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Near& near : around_) {
      const Eigen::Vector3d at = vector(mesh_.rest[index(near.vertex)] - own.center);
      spread += at * at.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    for (int k = 0; k < 2; ++k) {
      spread_[k] = solver.eigenvalues()[2 - k];
      axes_[k] = plain(solver.eigenvectors().col(2 - k));
    }
    for (Near& near : around_) {
      const Double3 at = projected(near.vertex, own);
      near.at[0] = static_cast<float>(at.x);
      near.at[1] = static_cast<float>(at.y);
    }
    in_plane_.resize(around_.size());
    for (std::size_t k = 0; k < around_.size(); ++k) {
      in_plane_[k] = projected(around_[k].vertex, own);
    }
  }
  Double3 projected(int vertex, const Patch& own) const {
    const Double3 at = mesh_.rest[index(vertex)] - own.center;
    return {dot(axes_[0], at), dot(axes_[1], at), 0.0};
  }

  /// A simplex in the plane.
  template <int kCorners>
  struct Flat {
    int number;  // of the simplex
    int vertices[kCorners];
    std::size_t at[kCorners];  // of its vertices, in around_
    Double3 center;            // [m]
    double radius;             // [m]
  };
  template <int kCorners>
  Flat<kCorners> flat(int number,
                      const Eigen::Matrix<int, kCorners, Eigen::Dynamic>& simplices) const {
    Flat<kCorners> flat{};
    flat.number = number;
    for (int k = 0; k < kCorners; ++k) {
      flat.vertices[k] = simplices(k, number);
      flat.at[k] = place_of(flat.vertices[k]);
      flat.center += 1.0 / kCorners * in_plane_[flat.at[k]];
    }
    for (const std::size_t k : flat.at) {
      flat.radius = std::max(flat.radius, norm(in_plane_[k] - flat.center));
    }
    return flat;
  }

  void take_rooms(int patch, const std::vector<int>& triangles, const std::vector<int>& edges) {
    rooms_.assign(around_.size(), std::numeric_limits<double>::infinity());
    std::vector<Flat<3>> flat_triangles;
    for (const int t : triangles) flat_triangles.push_back(flat<3>(t, mesh_.triangles));
    for (const int v : all_.vertices(patch)) {
      const std::size_t at = place_of(v);
      const Flat<1> own = {v, {v}, {at}, in_plane_[at], 0.0};
      for (const Flat<3>& other : flat_triangles) {
        take_room(SimplexPair::kPointTriangle, own, other);
      }
    }
    std::vector<Flat<2>> flat_edges;
    for (const int e : edges) flat_edges.push_back(flat<2>(e, mesh_.edges));
    for (const int e : all_.edges(patch)) {
      const Flat<2> own = flat<2>(e, mesh_.edges);
      for (const Flat<2>& other : flat_edges) {
        if (other.number > e) take_room(SimplexPair::kSegments, own, other);
      }
    }
    for (std::size_t k = 0; k < around_.size(); ++k) {
      around_[k].room = static_cast<float>(rooms_[k] - kRoundOff * mesh_.mean_edge);
    }
  }
  template <int kOwn, int kOther>
  void take_room(SimplexPair kind, const Flat<kOwn>& own, const Flat<kOther>& other) {
    const double apart = norm(own.center - other.center);
    double room = apart - own.radius - other.radius - thickness_;
    if (room < kExactWithin * mesh_.mean_edge) {
      if (share_a_vertex(own.vertices, other.vertices)) return;
      int particles[4];
      PairPlaces x{};
      for (int k = 0; k < 4; ++k) {
        particles[k] = k < kOwn ? own.vertices[k] : other.vertices[k - kOwn];
        x.at[k] = in_plane_[k < kOwn ? own.at[k] : other.at[k - kOwn]];
      }
      const double kept = sheet_pairs::thickness_of(joints_, kind, particles, thickness_);
      if (!(kept > 0.0)) return;  // never looked at
      room = norm(offset_between(x, nearest_weights(kind, x))) - kept;
    }
    for (const std::size_t k : other.at) rooms_[k] = std::min(rooms_[k], room);
  }
  std::size_t place_of(int vertex) const {
    const auto before = [](const Near& near, int i) { return near.vertex < i; };
    const auto middle = around_.begin() + inner_;
    auto found = std::lower_bound(around_.begin(), middle, vertex, before);
    if (found == middle || found->vertex != vertex) {
      found = std::lower_bound(middle, around_.end(), vertex, before);
    }
    return static_cast<std::size_t>(found - around_.begin());
  }

  const SheetMesh& mesh_;
  SheetJoints joints_;
  const SheetPatches& all_;
  double thickness_;
  int inner_ = 0;
  std::vector<Near> around_;
  std::vector<Double3> in_plane_;  // of these, at rest [m]
  std::vector<double> rooms_;      // likewise [m]
  Double3 axes_[2];                // of the plane
  double spread_[2] = {0.0, 0.0};  // along these [m²]
};

SheetPatches::SheetPatches(const SheetMesh& mesh, double thickness, double far,
                           const BoxHierarchy& triangle_tree, const BoxHierarchy& edge_tree)
    : pieces_(mesh.pieces), rest_(mesh.rest), thickness_(thickness) {
  cut(mesh);
  add_edges(mesh);
  patches_.push_back({static_cast<int>(vertices_.size()),
                      static_cast<int>(edges_.size()),
                      0,
                      0,
                      -1,
                      {0.0, 0.0, 0.0},
                      0.0,
                      {0.0, 0.0}});
  if (!(far > 0.0)) {
    for (Patch& patch : patches_) patch.piece = -1;
    return;
  }
  std::vector<std::vector<Near>> found(index(size()));
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    Surroundings surroundings(mesh, *this, thickness);
    for (int p = begin; p < end; ++p) {
      Patch& own = patches_[index(p)];
      own.center = middle_of(mesh.rest, vertices(p));
      for (const int v : vertices(p)) {
        own.radius = std::max(own.radius, norm(mesh.rest[index(v)] - own.center));
      }
      for (const int e : edges(p)) {
        own.radius = std::max(own.radius, norm(mesh.rest[index(mesh.edges(1, e))] - own.center));
      }
      own.radius += far;
      surroundings.find(p, triangle_tree, edge_tree);
      own.inner = surroundings.inner();
      std::copy_n(surroundings.spread(), 2, own.spread);
      found[index(p)] = surroundings.around();
    }
  });
  for (int p = 0; p < size(); ++p) {
    patches_[index(p)].around = static_cast<int>(around_.size());
    around_.insert(around_.end(), found[index(p)].begin(), found[index(p)].end());
  }
  patches_.back().around = static_cast<int>(around_.size());
}

namespace {

/// Where a plane's places at rest are, seen along the normal of the plane in which they now lie.
struct PlaneMap {
  Double3 start, end;     // of the patch's center [m]
  Double3 first, second;  // of the plane in which they lie
  double along[3];        // a place (a, b) at rest goes to (along[0] a + along[1] b, along[2] b)
  double least;           // the map's smallest singular value; not above 0 where there is no plane

  /// Squared distance of `from_center` from where a place at rest goes [m²].
  double squared_deviation(const Double3& from_center, const float* at) const {
    const auto a = static_cast<double>(at[0]), b = static_cast<double>(at[1]);
    const double u = dot(first, from_center) - along[0] * a - along[1] * b;
    const double v = dot(second, from_center) - along[2] * b;
    return u * u + v * v;
  }
};

/// Sets the map of which the images of the two axes are known.
void set_images(const Double3& image_a, const Double3& image_b, PlaneMap& map) {
  map.first = normalized(image_a);
  map.second = normalized(image_b - dot(map.first, image_b) * map.first);
  map.along[0] = dot(map.first, image_a);
  map.along[1] = dot(map.first, image_b);
  map.along[2] = dot(map.second, image_b);
  const double aa = squared_norm(image_a), bb = squared_norm(image_b), ab = dot(image_a, image_b);
  const double root = std::sqrt((aa - bb) * (aa - bb) + 4.0 * ab * ab);
  map.least = std::sqrt(std::max(0.0, 0.5 * (aa + bb - root)));
}

}  // namespace

void SheetPatches::find_bent(int patch, const Double3* start, const Double3* end,
                             const double* slacks, double margin, std::vector<int>& bent,
                             std::vector<double>& deviations) const {
  const Patch& own = at(patch);
  if (own.piece < 0) return;
  const Near* const first = around_.data() + own.around;
  const Near* const last = around_.data() + at(patch + 1).around;
  PlaneMap map{};
  const SheetMesh::Numbers vertices = this->vertices(patch);
  const double share = 1.0 / static_cast<double>(vertices.end() - vertices.begin());
  for (const int v : vertices) {
    map.start += share * start[v];
    map.end += share * end[v];
  }
  Double3 images[2] = {};
  for (const Near* near = first; near != last; ++near) {
    const Double3 from_center = (start[near->vertex] - map.start) + (end[near->vertex] - map.end);
    for (int k = 0; k < 2; ++k) images[k] += static_cast<double>(near->at[k]) * from_center;
  }
  set_images(0.5 / own.spread[0] * images[0], 0.5 / own.spread[1] * images[1], map);
  deviations.clear();
  double inner = 0.0, inner_slack = 0.0;
  const auto slack_of = [&](const Near& near) { return slacks ? slacks[near.vertex] : 0.0; };
  for (const Near* near = first; near != last; ++near) {
    const double squared = greater(map.squared_deviation(start[near->vertex] - map.start, near->at),
                                   map.squared_deviation(end[near->vertex] - map.end, near->at));
    deviations.push_back(squared);
    if (near - first >= own.inner) continue;
    inner = greater(inner, squared);
    inner_slack = greater(inner_slack, slack_of(*near));
  }
  // s d - t is at least s (d - t) - (1 - s) t.
  const double less =
      margin + std::sqrt(inner) + inner_slack + std::max(0.0, 1.0 - map.least) * thickness_;
  for (const Near* near = first; near != last; ++near) {
    const double room = map.least * static_cast<double>(near->room) - less - slack_of(*near);
    const bool keeps =
        room > 0.0 && deviations[static_cast<std::size_t>(near - first)] < room * room;
    if (!keeps) bent.push_back(near->vertex);
  }
}

}  // namespace pliant
