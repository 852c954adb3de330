#pragma once

#include <array>
#include <vector>

#include "pliant/core/body/held_vertex.h"
#include "pliant/core/body/particles.h"
#include "pliant/elements/yarn.h"

namespace pliant {

/// Particles are no farther from a fixed or held one than the shortest path along the cloth between
/// the two is long, since no edge of that path is longer (long range attachments, Kim, Chentanez
/// and Müller-Fischer 2012). It follows from limits of the edges, and takes one sweep where these
/// take as many as there are edges on the path.
class Tethers {
 public:
  /// Edges may become `max` times as long as at rest.
  Tethers(const std::vector<ClothEdge>& edges, int particles, double max);

  /// Finds the paths anew where other particles are fixed or held than in the last call; `held`
  /// ones are each there once.
  void follow(const Particles& particles, const std::vector<HeldVertex>& held);
  void reset_multipliers();
  /// Moves x[i] by mobility[i] x force towards what it is too far from.
  void relax(const Eigen::VectorXd& mobility, Positions& x);
  void add_forces(Forces& f) const;
  int size() const { return static_cast<int>(tethers_.size()); }

 private:
  struct Tether {
    int particle, anchor;                             // which is fixed or held
    double length;                                    // [m]
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // multiplier, away from the anchor [N]
    Eigen::Vector3d last = Eigen::Vector3d::Zero();   // of it, by the last sweep [N]
  };
  /// A held anchor, and what its tethers pull at it in a sweep.
  struct Pull {
    int particle;
    Eigen::Vector3d start;  // of the sweep [m]
    Eigen::Vector3d force;  // [N]
    double stiffness;       // of all that is at it [N/m]
  };
  struct Path {
    double length;  // [m]
    int from;       // the nearest anchor
  };
  /// Moves held anchors to where they about balance what pulls at them.
  void yield(const Eigen::VectorXd& mobility, Positions& x);
  /// Moves them to where the forces of the sweep bring them: these are in pairs to round-off.
  void balance(const Eigen::VectorXd& mobility, Positions& x);
  /// Pieces of cloth that are fixed or held, each its particles.
  std::vector<std::vector<int>> islands() const;
  std::vector<Path> paths_from(const std::vector<int>& sources) const;
  void tie(const std::vector<int>& sources);

  double max_;
  std::vector<int> first_;  // of particle i from first_[i] on in ends_
  struct End {
    int other;
    double length;
  };
  std::vector<End> ends_;
  std::vector<char> is_anchor_;
  std::vector<HeldVertex> held_;
  std::vector<Pull> pulls_;      // of held_
  std::vector<int> pull_of_;     // of particle i; -1 where it is not held
  std::vector<Tether> tethers_;  // by particle
  std::vector<int> begins_;      // of particle i
};

}  // namespace pliant
