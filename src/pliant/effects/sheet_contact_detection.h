#pragma once

#include <array>
#include <vector>

#include "pliant/effects/pair_detection.h"
#include "pliant/geometry/box_hierarchy.h"
#include "pliant/geometry/nearest_pair.h"

namespace pliant {

/// Finds where a sheet without inside comes near itself: vertices and triangles, edges and edges,
/// along the whole way of a step. The side on which two places stay is that on which they first
/// came near, or were when the step began: so nothing passes, however thin and fast it is.
///
/// What is joined by an edge touches below half of its distance at rest, and the thickness is at
/// most half of the mean edge: else a smooth sheet would touch itself everywhere.
class SheetContactDetection final : public PairDetection {
 public:
  /// `rest` 3 x n [m], all of `triangles`' vertices.
  SheetContactDetection(const Positions& rest, const Eigen::Matrix3Xi& triangles,
                        const Options& options);

  void find(const Particles& particles, double dt, std::vector<PairContact>& contacts) override;
  bool is_final() const override { return false; }
  int sweeps() const override { return 1; }

  double thickness() const { return thickness_; }  ///< that is kept [m]

 private:
  using Box = BoxHierarchy::Box;
  using Four = Eigen::Vector4i;  // particles of a vertex and a triangle, or of two edges
  struct Found {
    SimplexPair kind;
    Four particles;
    double thickness;  // [m]
    Approach approach;
  };

  void take_edges(const Eigen::Matrix3Xi& triangles);
  /// Boxes around the ways of simplices, wider by half of what counts as near.
  template <int kCorners>
  void enclose(const Eigen::Matrix<int, kCorners, Eigen::Dynamic>& simplices,
               std::vector<Box>& boxes) const;
  /// Drops, of what was found from `first` on, nearest points that several triangles share.
  static void keep_first(std::size_t first, std::vector<Found>& found);
  void look_around_vertex(int vertex, std::vector<Found>& found) const;
  void look_around_edge(int edge, std::vector<Found>& found) const;
  void look(SimplexPair kind, const Four& particles, std::vector<Found>& found) const;
  bool are_joined(SimplexPair kind, const Four& particles) const;
  bool share_an_edge(int a, int b) const;
  PairContact contact(const Found& found, double dt) const;
  /// When the step began, twice the area long; every triangle is looked at, but seldom.
  Eigen::Vector3d normal_of(int vertex) const;
  /// Where two simplices lie on each other, the way that the first should leave.
  Eigen::Vector3d way_out(const Found& found) const;

  Positions rest_;
  Eigen::Matrix3Xi triangles_;
  Eigen::Matrix2Xi edges_;
  std::vector<std::vector<int>> neighbors_;  // of vertices, ascending
  double thickness_, margin_, friction_;
  // Of the running step; reused. Ends are without the mean motion.
  Positions start_, end_;
  std::vector<Box> triangle_boxes_, edge_boxes_;
  BoxHierarchy triangle_tree_, edge_tree_;
  std::vector<std::vector<Found>> blocks_;
};

}  // namespace pliant
