#pragma once

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "pliant/core/world.h"
#include "support/meshes/intersections.h"

namespace pliant {

/// An edge of one body that passes through a triangle of another or of its own.
struct Pass {
  std::string edge_of, triangle_of;
  Eigen::Vector3d place;  ///< the edge's middle [m]
};

/// Every such pass among the surfaces of a world's bodies: an independent search, which shares no
/// code with the contacts. Bodies whose surface is made anew for each state (particles) have no
/// triangles that could pass.
class PassSearch {
 public:
  explicit PassSearch(const World& world) {
    for (const Body& body : world.bodies()) {
      if (!body.model->surface_changes()) add(body);
    }
    for (std::size_t e = 0; e < edges_.size(); ++e) add_box(edges_[e].box, static_cast<int>(e));
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      add_box(triangles_[t].box, -1 - static_cast<int>(t));
    }
    std::sort(boxes_.begin(), boxes_.end(),
              [](const Box& a, const Box& b) { return a.box.min().x() < b.box.min().x(); });
  }

  std::vector<Pass> find() const {
    std::vector<Pass> passes;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      for (std::size_t j = i + 1; j < boxes_.size(); ++j) {
        if (boxes_[j].box.min().x() > boxes_[i].box.max().x()) break;
        const bool is_edge = boxes_[i].index >= 0;
        if (is_edge == (boxes_[j].index >= 0) || !boxes_[i].box.intersects(boxes_[j].box)) continue;
        try_pair(edges_[is_edge ? boxes_[i].index : boxes_[j].index],
                 triangles_[-1 - (is_edge ? boxes_[j].index : boxes_[i].index)], passes);
      }
    }
    return passes;
  }

 private:
  struct Edge {
    const Body* body;
    std::array<int, 2> vertices;
    Eigen::Vector3d p, q;
    Eigen::AlignedBox3d box;
  };
  struct Triangle {
    const Body* body;
    Eigen::Vector3i vertices;
    Eigen::Vector3d a, b, c;
    Eigen::AlignedBox3d box;
  };
  struct Box {
    Eigen::AlignedBox3d box;
    int index;  // of an edge, or -1 - that of a triangle
  };

  void add(const Body& body) {
    const TriangleMesh mesh = body.model->surface();
    const auto at = [&](int i) -> Eigen::Vector3d { return mesh.vertices.col(i); };
    for (const auto& [i, j] : edges_of(mesh.triangles)) {
      edges_.push_back({&body, {i, j}, at(i), at(j), Eigen::AlignedBox3d(at(i))});
      edges_.back().box.extend(at(j));
    }
    for (const auto t : mesh.triangles.colwise()) {
      triangles_.push_back({&body, t, at(t[0]), at(t[1]), at(t[2]), Eigen::AlignedBox3d(at(t[0]))});
      triangles_.back().box.extend(at(t[1])).extend(at(t[2]));
    }
  }
  void add_box(const Eigen::AlignedBox3d& box, int index) { boxes_.push_back({box, index}); }

  static void try_pair(const Edge& edge, const Triangle& triangle, std::vector<Pass>& passes) {
    const auto has = [&](int i) { return (triangle.vertices.array() == i).any(); };
    if (edge.body == triangle.body && (has(edge.vertices[0]) || has(edge.vertices[1]))) return;
    if (!passes_through(edge.p, edge.q, triangle.a, triangle.b, triangle.c)) return;
    passes.push_back({edge.body->name, triangle.body->name, 0.5 * (edge.p + edge.q)});
  }

  std::vector<Edge> edges_;
  std::vector<Triangle> triangles_;
  std::vector<Box> boxes_;
};

inline std::vector<Pass> find_passes(const World& world) { return PassSearch(world).find(); }

}  // namespace pliant
