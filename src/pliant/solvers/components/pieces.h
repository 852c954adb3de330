#pragma once

#include <vector>

#include "pliant/core/parallel/parallel.h"
#include "pliant/solvers/components/components.h"

namespace pliant {

/// What errors are compared within: each connected component of more than one particle, and, as the
/// last one, all free particles that nothing ties to another. A body that weighs little beside the
/// others of its system is a piece of its own, so that its errors do not vanish among their forces.
class Pieces {
 public:
  static constexpr int kNone = -1;

  Pieces() = default;
  Pieces(const Components& components, const Eigen::VectorXd& mass);
  /// The piece of each particle; kNone of one that is pinned.
  static std::vector<int> of_particles(const Components& components);

  int count() const { return static_cast<int>(mass_shares_.size()); }
  /// Whether all free particles are in one.
  bool are_one() const { return begins_.empty(); }
  /// Of all free particles' mass.
  double mass_share(int piece) const { return mass_shares_[static_cast<std::size_t>(piece)]; }

  /// `sums` of value(i) over each piece's particles, the same for any number of threads. Not where
  /// are_one(): no list of particles is kept then.
  template <class Value>
  void sum(const Value& value, Eigen::VectorXd& sums) const {
    if (sums.size() != count()) sums.resize(count());
    parallel_for(0, count(), 1, [&](int first, int last) {
      for (int piece = first; piece < last; ++piece) {
        double sum = 0.0;
        const auto at = static_cast<std::size_t>(piece);
        for (int k = begins_[at]; k < begins_[at + 1]; ++k) {
          sum += value(members_[static_cast<std::size_t>(k)]);
        }
        sums[piece] = sum;
      }
    });
  }

 private:
  std::vector<double> mass_shares_;
  std::vector<int> members_;  // particles, piece by piece, in order
  std::vector<int> begins_;   // of each piece's members, and the end of the last one's
};

}  // namespace pliant
