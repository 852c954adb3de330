#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pliant/effects/body_contact/body_pair_table.h"
#include "pliant/effects/self_contact/sheet_mesh.h"
#include "pliant/effects/self_contact/sheet_patches.h"
#include "pliant/effects/self_contact/sheet_search.h"
#include "pliant/geometry/search/box_hierarchy.h"

namespace pliant {

/// The bodies whose surfaces are searched together, of each vertex.
struct SheetBodies {
  std::vector<int> body;
  std::vector<double> radius;  ///< of vertices that are balls; else 0 [m]
  std::vector<double> half;    ///< the most that a vertex brings to the distance of a pair [m]
  BodyPairTable pairs;         ///< which bodies meet, and what they keep besides radii

  bool may_meet(int a, int b) const { return pairs.touches(body_of(a), body_of(b)); }
  int body_of(int vertex) const { return body[static_cast<std::size_t>(vertex)]; }
  /// The distance that a pair of vertices keeps; of two surfaces all of what their bodies keep, of
  /// a ball and a surface the surface's half [m].
  double kept(int a, int b) const {
    const bool is_ball = radius_of(a) > 0.0 || radius_of(b) > 0.0;
    const double surfaces = pairs(body_of(a), body_of(b)).thickness;
    return (is_ball ? 0.5 : 1.0) * surfaces + radius_of(a) + radius_of(b);
  }

 private:
  double radius_of(int vertex) const { return radius[static_cast<std::size_t>(vertex)]; }
};

/// On the CPU, in threads, patch by patch of the sheet. What lies around a patch at rest is looked
/// at where the neighbourhood has bent so much that it may come near. Of the rest, and of what lies
/// around where that moves slowly, candidates come from trees of boxes around the paths of
/// triangles and edges; collected wider than needed, they serve some steps, and each is looked at
/// when what has moved since could have brought it near.
class SheetTreeSearch final : public SheetSearch {
 public:
  /// `thickness` that is kept, and `margin` within which more is found [m].
  SheetTreeSearch(const Positions& rest, const Eigen::Matrix3Xi& triangles, double thickness,
                  double margin);

  /// Of several bodies, and between these alone. Vertices without triangles are balls.
  SheetTreeSearch(const Positions& rest, const Eigen::Matrix3Xi& triangles, SheetBodies bodies,
                  double margin);

  SheetNearPairs find(const Positions& start, const Positions& end) override;
  bool limit_displacement(const Particles& particles, Positions& x, SheetNearPairs& found) override;
  /// Puts vertices `x` where they are when each goes that share of its displacement.
  using Placement = std::function<void(const std::vector<double>& shares, Positions& x)>;
  /// The same for vertices that others carry, which `place` moves.
  bool limit_displacement(const Placement& place, Positions& x, SheetNearPairs& found);

  const SheetMesh& mesh() const { return mesh_; }
  /// That pairs of a sheet keep [m].
  double least_thickness() const { return least_thickness_; }
  /// The most that is kept; within one sheet at most half of the mean edge [m].
  double thickness() const { return thickness_; }
  double margin() const { return margin_; }  ///< [m]
  /// More than so far from the next find() on [m].
  void set_margin(double margin) { margin_ = margin; }
  /// Their shape is that of the sheet at rest.
  const BoxHierarchy& triangle_tree() const { return triangle_tree_; }
  const BoxHierarchy& edge_tree() const { return edge_tree_; }

 private:
  using Box = BoxHierarchy::Box;
  /// Of a pair in the order of all: first by its own vertex, or edge behind all vertices, then by
  /// the rank of the other simplex in its tree.
  struct Place {
    int own, rank;
    bool operator<(const Place& other) const {
      return own != other.own ? own < other.own : rank < other.rank;
    }
  };
  /// A pair that may come near soon.
  struct Candidate {
    SimplexPair kind;
    int particles[4];
    Place place;
    double thickness;  // [m]
    double wake;       // of path_: before, it cannot be near [m]
    SheetGap gap;
  };
  struct Passage {
    std::size_t near;
    double time;  // at which they would pass
  };
  /// What is found of a patch.
  struct Block {
    std::vector<Candidate> candidates;  // that do not lie around it at rest, or are known to
    bool knows_around = false;          // whether what does is among them
    double wake = 0.0;                  // the earliest of them [m]
    std::vector<SheetNearPair> near;    // more than one of these may make one contact
    std::vector<Place> places;          // of these
    std::vector<std::size_t> found;     // of them
    std::vector<Passage> passages;      // of them, on the paths last looked at
  };
  /// Of a thread; reused.
  struct Scratch {
    std::vector<int> bent, strangers;
    std::vector<char> is_bent;  // of each vertex
    std::vector<double> deviations;
    std::vector<Box> boxes;
    std::vector<std::size_t> order;
    std::vector<SheetNearPair> near;
    std::vector<Place> places;

    /// Forgets which of `count` simplices were seen.
    void begin(std::size_t count) {
      if (seen_in.size() < count) seen_in.resize(count, 0);
      if (++round == 0) {
        std::fill(seen_in.begin(), seen_in.end(), 0);
        round = 1;
      }
    }
    bool is_first(int simplex) {
      return std::exchange(seen_in[static_cast<std::size_t>(simplex)], round) != round;
    }
    std::vector<std::uint32_t> seen_in;  // of each simplex the last round
    std::uint32_t round = 0;
  };

  void build_trees();
  void cut();
  double half_thickness(int vertex) const {
    return bodies_ ? bodies_->half[static_cast<std::size_t>(vertex)] : 0.5 * thickness_;
  }
  /// Whether pairs of these vertices count.
  bool may_meet(int a, int b) const { return !bodies_ || bodies_->may_meet(a, b); }
  /// Around a vertex's path, wider by half of what counts as near and by its slack.
  Box box_of(int vertex) const;
  /// Boxes around the paths of simplices.
  template <int kCorners>
  void enclose(const Eigen::Matrix<int, kCorners, Eigen::Dynamic>& simplices,
               std::vector<Box>& boxes) const;
  /// Sets start_ and end_, and how far they are from those before.
  void follow(const Double3* start, const Double3* end);
  /// Finds what comes near on the straight paths from `start` to `end`.
  void search(const Double3* start, const Double3* end);
  SheetNearPairs gather();
  /// Whether what was found holds of the paths to `x` as well.
  bool is_seen(const Double3* x) const;
  /// Takes from shares_ what pairs that would pass on their paths to `x` have too much; false where
  /// none would. With `stop` they go nowhere.
  bool shorten(const Double3* x, bool stop);
  void look_for_passages(const Double3* x, Block& block) const;
  /// Whether all that may come near in this step is among the candidates.
  bool are_candidates_good() const;
  void collect();
  /// Candidates of a patch: what does not lie around it at rest, and what does where it moves
  /// slowly and has bent so much that it may come near.
  void collect(int patch, Block& block, Scratch& scratch) const;
  /// Of several bodies: those of the patches, and boxes around the paths of bodies.
  void find_patch_bodies();
  void enclose_bodies();
  /// The part of a patch's `box` where it may meet something: of several bodies where others are.
  Box box_of_others(int patch, const Box& box) const;
  /// Those simplices whose boxes overlap `box`: fills scratch.strangers.
  template <class Simplices>
  void find_strangers(int patch, const BoxHierarchy& tree, const Simplices& simplices,
                      const Box& box, Scratch& scratch) const;
  void collect_of_vertices(int patch, Block& block, Scratch& scratch) const;
  void collect_of_edges(int patch, Block& block, Scratch& scratch) const;
  Candidate candidate(SimplexPair kind, const std::array<int, 4>& particles, Place place) const;
  /// That candidates keep, or `thickness_` [m].
  double least_of_candidates() const;
  double thickness_of(SimplexPair kind, const int* particles) const;
  /// Finds all that comes near of a patch.
  void look(int patch, Block& block, Scratch& scratch) const;
  void look_at_candidates(Block& block) const;
  /// At what lies around the patch at rest, where it has bent.
  void look_around(int patch, Block& block, Scratch& scratch) const;
  void look_around_vertices(int patch, Block& block, Scratch& scratch) const;
  void look_around_edges(int patch, Block& block, Scratch& scratch) const;
  /// At a pair of which nothing is known.
  void look_at(SimplexPair kind, const std::array<int, 4>& particles, Place place,
               Block& block) const;
  /// Around a simplex's path, wider by `reach` [m].
  template <class Vertices>
  Box swept_box(const Vertices& vertices, double reach) const;
  Place place_of(SimplexPair kind, int own, int other) const;
  static void put_in_order(Block& block, Scratch& scratch);
  /// Which of what comes near makes contacts: of nearest points that triangles share the first.
  static void choose(Block& block);

  SheetMesh mesh_;
  std::optional<SheetBodies> bodies_;  // without: of one sheet, which meets itself
  double thickness_, margin_;
  // Of the running step; reused. Ends are without the mean motion.
  std::vector<Double3> start_, end_;
  std::vector<Box> triangle_boxes_, edge_boxes_;
  BoxHierarchy triangle_tree_, edge_tree_;
  std::vector<int> triangle_ranks_, edge_ranks_;  // in the orders of the trees
  std::unique_ptr<const SheetPatches> patches_;   // made by the first search
  std::vector<Block> blocks_;                     // of patches
  std::vector<int> patch_bodies_;                 // -1: it has parts of several bodies
  std::vector<Box> body_boxes_;                   // around their paths, as wide as candidates'
  std::vector<SheetNearPair> found_;
  std::vector<std::size_t> begins_;  // in found_, of vertices and edges
  std::vector<Double3> sums_;
  // Collected wider than needed by this at each vertex, candidates are good for some steps [m].
  std::vector<double> slacks_;
  std::vector<Double3> collected_start_, collected_end_;  // with candidates; empty: never
  double least_thickness_ = 0.0;                          // of pairs [m]
  double path_ = 0.0;    // that no vertex went further than, from step to step [m]
  double motion_ = 0.0;  // likewise, of any vertex in this step [m]
  Double3 mean_motion_ = {0.0, 0.0, 0.0};  // [m]
  std::vector<double> shares_, cuts_;  // of the paths that vertices may go, and of those the last
  std::vector<Double3> wanted_;
};

}  // namespace pliant
