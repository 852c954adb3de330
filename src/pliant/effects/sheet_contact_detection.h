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
  bool advance(const Particles& particles, double dt, Positions& x,
               std::vector<PairContact>& contacts) override;
  int most_particles() const override { return 4; }
  int sweeps() const override { return 1; }
  /// Wet layers hold on to each other: a vertex to the nearest triangle on either side of it. Each
  /// of two layers brings half of the adhesion, of water that is the mean of both.
  void moisten(const WetContact* wet) override;

  double thickness() const { return thickness_; }  ///< that is kept [m]

 private:
  using Box = BoxHierarchy::Box;
  using Four = Eigen::Vector4i;  // particles of a vertex and a triangle, or of two edges
  struct Found {
    SimplexPair kind;
    Four particles;
    double thickness;  // [m]
    bool may_stick;
    Approach approach;
    double pull = 0.0;  // that water withstands [N]
  };
  /// A pair that comes near in this step; more than one of these may make one contact.
  struct Near {
    SimplexPair kind;
    Four particles;
    double thickness;     // [m]
    double start;         // distance when the step began [m]
    Eigen::Vector3d way;  // between them where they first are near [m]
  };
  /// A pair that may come near soon.
  struct Candidate {
    SimplexPair kind;
    Four particles;
    double thickness;  // [m]
    bool may_stick;    // they are not of one place at rest
    double wake;       // of path_: before, it cannot be near [m]
    // In which the first simplex lay beyond the second when it was looked at; 0: not known.
    Eigen::Vector3f apart = Eigen::Vector3f::Zero();
  };
  /// Some vertices or edges, which one thread takes at once.
  struct Block {
    std::vector<Candidate> candidates;
    double wake = 0.0;  // the earliest of them [m]
    std::vector<Near> near;
    std::vector<Found> found;
  };

  void take_edges(const Eigen::Matrix3Xi& triangles);
  void label_pieces();
  /// Around a vertex's way, wider by half of what counts as near and by its slack.
  Box box_of(int vertex) const;
  /// Boxes around the ways of simplices.
  template <int kCorners>
  void enclose(const Eigen::Matrix<int, kCorners, Eigen::Dynamic>& simplices,
               std::vector<Box>& boxes) const;
  /// Drops, of what was found from `first` on, nearest points that several triangles share.
  static void keep_first(std::size_t first, std::vector<Found>& found);
  /// Sets start_ and end_, and how far they are from those before.
  void follow(const Positions& start, const Positions& end);
  /// Finds what comes near on the straight ways from `start` to `end`.
  void search(const Positions& start, const Positions& end);
  void make_contacts(double dt, std::vector<PairContact>& contacts) const;
  /// Whether what was found holds of the ways to `x` as well.
  bool is_seen(const Positions& x) const;
  /// Takes from shares_ what pairs that would pass on their ways to `x` have too much; false where
  /// none would. With `stop` they go nowhere.
  bool shorten(const Positions& x, bool stop);
  static bool passes(const Near& near, const FourPoints& start, const FourPoints& end,
                     double& time);
  /// Whether all that may come near in this step is among the candidates.
  bool are_candidates_good() const;
  void collect();
  void collect_around_vertex(int vertex, std::vector<Candidate>& candidates) const;
  void collect_around_edge(int edge, std::vector<Candidate>& candidates) const;
  Candidate candidate(SimplexPair kind, const Four& particles) const;
  void look(Block& block) const;
  /// How far the first simplex is beyond the second along a direction no longer than 1: they are no
  /// nearer, nor is what moves straight on between two such states.
  static double gap_along(SimplexPair kind, const Eigen::Vector3d& direction, const FourPoints& x);
  /// Of a vertex, from `first` on.
  void stick(std::size_t first, std::vector<Found>& found) const;
  void end_vertex(std::size_t first, std::vector<Found>& found) const;
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
  std::vector<int> pieces_;                  // that edges join; of vertices
  double thickness_, margin_, friction_;
  const WetContact* wet_ = nullptr;  // null: all is dry
  // Of the running step; reused. Ends are without the mean motion.
  Positions start_, end_;
  std::vector<Box> triangle_boxes_, edge_boxes_;
  BoxHierarchy triangle_tree_, edge_tree_;
  std::vector<Block> blocks_;
  // Collected wider than needed by this at each vertex, candidates are good for some steps [m].
  Eigen::VectorXd slacks_;
  double mean_edge_ = 0.0;                     // [m]
  Positions collected_start_, collected_end_;  // when candidates were collected; empty: never
  double least_thickness_ = 0.0;               // of candidates [m]
  double path_ = 0.0;    // that no vertex went further than, from step to step [m]
  double motion_ = 0.0;  // likewise, of any vertex in this step [m]
  Eigen::Vector3d mean_motion_ = Eigen::Vector3d::Zero();  // [m]
  Eigen::VectorXd shares_, cuts_;  // of the ways that vertices may go, and of those the last ones
  Positions wanted_;
};

}  // namespace pliant
