#pragma once

#include <array>
#include <vector>

#include "pliant/core/particles.h"

namespace pliant {

/// What cloth cannot be longer than between two of its vertices.
struct ClothEdge {
  int i, j;
  double length;  ///< along threads, at rest [m]
};

/// Particles are no farther from a fixed one than the shortest way along the cloth between the two
/// is long, since no edge of that way is longer (long range attachments, Kim, Chentanez and
/// Müller-Fischer 2012). It follows from limits of the edges, and takes one sweep where these take
/// as many as there are edges on the way.
class Tethers {
 public:
  /// Edges may become `max` times as long as at rest.
  Tethers(const std::vector<ClothEdge>& edges, int particles, double max);

  /// Finds the ways anew where other particles are fixed than in the last call.
  void follow(const Particles& particles);
  void reset_multipliers();
  /// Moves x[i] by mobility[i] x force towards what it is too far from.
  void relax(const Eigen::VectorXd& mobility, Positions& x);
  void add_forces(Forces& f) const;
  int size() const { return static_cast<int>(tethers_.size()); }

 private:
  struct Tether {
    int particle, fixed;
    double length;                                    // [m]
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // multiplier, away from the fixed one [N]
  };
  struct Way {
    double length;  // [m]
    int from;       // the nearest of the fixed ones
  };
  /// Pieces of cloth that are fixed, each its particles.
  std::vector<std::vector<int>> islands() const;
  std::vector<Way> ways_from(const std::vector<int>& sources) const;
  void tie(const std::vector<int>& sources);

  double max_;
  std::vector<int> first_;  // of particle i from first_[i] on in ends_
  struct End {
    int other;
    double length;
  };
  std::vector<End> ends_;
  std::vector<char> is_fixed_;
  std::vector<Tether> tethers_;  // by particle
  std::vector<int> begins_;      // of particle i
};

}  // namespace pliant
