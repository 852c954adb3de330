#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/effects/self_contact/sheet_mesh.h"
#include "pliant/geometry/search/box_hierarchy.h"

namespace pliant {

/// A sheet cut into small patches of vertices, each with the edges that begin there. What lies
/// around a patch at rest cannot come near it while the neighbourhood is a smooth surface above one
/// plane: one look at a neighbourhood then stands for thousands of pairs of simplices.
///
/// Seen along the normal of that plane, vertices are where a linear map with smallest singular
/// value s takes them from the plane of the neighbourhood at rest, but for deviations e. Two points
/// that are d apart in the plane at rest are at least s d - e_own - e_other apart, however far they
/// are displaced along the normal. So a pair that keeps a distance t stays apart while e_own +
/// e_other < s d - t. For each vertex around a patch the least d - t of pairs with it is known, its
/// room.
class SheetPatches {
 public:
  /// `far`: how far around its own simplices a patch knows the sheet [m]; 0: nothing, as of bodies
  /// whose surfaces do not meet themselves. The trees hold the sheet's boxes at rest.
  SheetPatches(const SheetMesh& mesh, double thickness, double far,
               const BoxHierarchy& triangle_tree, const BoxHierarchy& edge_tree);

  int size() const { return static_cast<int>(patches_.size()) - 1; }
  /// Its own, ascending.
  SheetMesh::Numbers vertices(int patch) const;
  SheetMesh::Numbers edges(int patch) const;

  /// Whether a simplex with these vertices lies around the patch at rest.
  template <class Vertices>
  bool is_around(int patch, const Vertices& vertices) const;

  /// Appends the vertices around a patch that may have come nearer to it than what pairs keep and
  /// `margin` on the straight paths from `start` to `end` [m].
  void find_bent(int patch, const Double3* start, const Double3* end, const double* slacks,
                 double margin, std::vector<int>& bent, std::vector<double>& deviations) const;

 private:
  struct Patch {
    int vertices, edges;  // where its own begin; they end where the next patch's begin
    int around, inner;    // where the vertices around it begin, and how many are of own simplices
    int piece;            // of the sheet; -1: it knows nothing around it
    Double3 center;       // of its own vertices at rest [m]
    double radius;        // of the neighbourhood [m]
    double spread[2];     // sums of squares of places in it [m²]
  };
  /// A vertex around a patch.
  struct Near {
    int vertex;
    float at[2];  // at rest, along the neighbourhood's longest axes, from the patch's center [m]
    float room;   // [m]
  };
  class Surroundings;

  void cut(const SheetMesh& mesh);
  void split(const SheetMesh& mesh, int first, int count);
  void add_edges(const SheetMesh& mesh);
  const Patch& at(int patch) const { return patches_[static_cast<std::size_t>(patch)]; }

  std::vector<Patch> patches_;         // and one more, where the last one ends
  std::vector<int> vertices_, edges_;  // of all patches
  std::vector<Near> around_;           // likewise
  std::vector<int> pieces_;            // of vertices
  std::vector<Double3> rest_;          // [m]
  double thickness_;                   // [m]
};

template <class Vertices>
bool SheetPatches::is_around(int patch, const Vertices& vertices) const {
  const Patch& own = patches_[static_cast<std::size_t>(patch)];
  if (own.piece < 0 || pieces_[static_cast<std::size_t>(vertices[0])] != own.piece) return false;
  Double3 sum = {0.0, 0.0, 0.0};
  for (const int i : vertices) sum += rest_[static_cast<std::size_t>(i)];
  const auto count = static_cast<double>(vertices.size());
  return squared_norm(1.0 / count * sum - own.center) < own.radius * own.radius;
}

}  // namespace pliant
