#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "pliant/core/state_archive.h"
#include "pliant/effects/air/trapped_volume.h"

namespace pliant {

/// Height of a bubble below which its volume counts as none [m].
constexpr double kTinyBubbleHeight = 1e-6;

/// Air under a connected piece of cloth that is off what it lies on.
struct Bubble {
  std::vector<int> vertices;  ///< of the cloth: lifted ones, and those around them that may lie
  CoverTriangles triangles;   ///< whose corners are indices into `vertices`
  Eigen::VectorXd areas;      ///< of each vertex within the bubble, at rest [m²]
  double edge_length = 0.0;   ///< of the cloth's edge that is lifted with it, at rest [m]
  bool is_open = false;       ///< its edge is off: the room's air goes in and out
  double amount = 0.0;        ///< V_0, volume of its air at atmospheric pressure [m³]
  double gauge = 0.0;         ///< p - p_a, the multiplier [Pa]
  double layers = 0.0;        ///< of the volume under it what is cloth, as the step began [m³]
  double start_volume = 0.0;  ///< volume that air had as the step began [m³]
  // Work of a step, by index into `vertices`.
  Positions x, moved;
  Eigen::Matrix3Xd gradient;
  Eigen::VectorXd mobility, start_heights;
  Eigen::VectorXd held;  ///< how far water pulls each vertex back; empty: none is wet [m]
  FootPoints foot_points;
  double conductance = 0.0;  ///< of weave and edge [m³/(s Pa)]
  bool is_limited = false;
  double start_gauge = 0.0;  ///< as the step began [Pa]
  double expected = 0.0;     ///< gauge after the step's last relaxation, 0 before the first [Pa]
  double change = 0.0;       ///< of the gauge, during the final projections of others [Pa]
  double pressed = 0.0;      ///< how far settling moved a vertex [m]
};

/// Which vertices of a cloth are off their obstacle, as connected bubbles, and how these hand on
/// their air when they split, merge and vanish: none is lost.
class Bubbles {
 public:
  /// `rest` 3 x n [m], all of `triangles`' vertices.
  Bubbles(const Positions& rest, const Eigen::Matrix3Xi& triangles);

  /// Follows the cloth to where its vertices are `heights` above what it may lie on [m];
  /// `trapped(bubble)` is the volume under one there. An edge above `gap` opens its bubble.
  /// `loose` is air that has no bubble yet, at atmospheric pressure [m³].
  template <class Trapped>
  void follow(const Eigen::VectorXd& heights, double gap, double& loose, const Trapped& trapped);

  std::vector<Bubble>& all() { return bubbles_; }
  const std::vector<Bubble>& all() const { return bubbles_; }
  /// The cloth that is over none of them, as one without air.
  Bubble& lying() { return lying_; }
  const Bubble& lying() const { return lying_; }
  /// Whether a vertex is in more than one of all(), as those around a fold between two are.
  bool share_vertices() const { return share_vertices_; }
  void clear();
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  struct AirTransfer {
    int from, to;
    double weight;  // area times height of what both hold [m³]
  };
  /// Sets next_, the bubble of each lifted vertex; false where nothing changed.
  bool label(const Eigen::VectorXd& heights, bool all_lifted);
  void flood(int seed, int bubble);
  /// Makes the bubbles of labels_, without air.
  void rebuild();
  /// The bubble of each triangle, or -1.
  std::vector<int> owners() const;
  void add_members(const std::vector<int>& owners, int number, std::vector<int>& local,
                   Bubble& bubble) const;
  std::vector<AirTransfer> transfers(const std::vector<int>& before,
                                     const Eigen::VectorXd& heights) const;
  void share_out(const std::vector<Bubble>& before, const std::vector<AirTransfer>& transfers,
                 const std::vector<double>& volumes, double& loose);
  void open_lifted(const Eigen::VectorXd& heights, double gap);
  void take_in(double loose, const Eigen::VectorXd& heights);

  CoverTriangles triangles_;
  Eigen::VectorXd triangle_areas_, vertex_areas_;  // at rest [m²]
  std::vector<std::array<int, 2>> rim_;            // edges of the cloth that have one triangle
  std::vector<double> rim_lengths_;                // at rest [m]
  std::vector<int> first_neighbor_, neighbors_;    // of vertex i from first_neighbor_[i] on
  std::vector<int> labels_, next_;                 // bubble of each lifted vertex, or -1
  std::vector<int> open_;                          // vertices that a flood still goes on from
  std::vector<char> flat_;                         // whether all of a bubble lies
  std::vector<Bubble> bubbles_;
  bool share_vertices_ = false;
  Bubble lying_;
};

template <class Trapped>
void Bubbles::follow(const Eigen::VectorXd& heights, double gap, double& loose,
                     const Trapped& trapped) {
  if (label(heights, false)) {
    const std::vector<int> before = labels_;
    const std::vector<Bubble> old = std::move(bubbles_);
    labels_ = next_;
    rebuild();
    std::vector<double> volumes;
    for (Bubble& bubble : bubbles_) volumes.push_back(std::max(0.0, trapped(bubble)));
    share_out(old, transfers(before, heights), volumes, loose);
  } else {
    for (Bubble& bubble : bubbles_) {
      if (bubble.is_open) bubble.amount = std::max(0.0, trapped(bubble));
    }
  }
  open_lifted(heights, gap);
  if (loose > 0.0) take_in(loose, heights);
  loose = 0.0;
}

}  // namespace pliant
