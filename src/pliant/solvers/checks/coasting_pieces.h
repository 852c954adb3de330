#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/state_archive.h"
#include "pliant/solvers/checks/held_directions.h"

namespace pliant {

/// How far pieces of a system go since the last estimate of their error, with the velocity that
/// they should not have. Contact takes that velocity for good: at once along its normals, and by
/// friction and by what gives way in a while.
class CoastingPieces {
 public:
  /// None has such a velocity.
  void begin() { begin(0); }
  /// Each has the mean of what its particles of mass `mass` [kg] `gained` in a step [m]; `piece_of`
  /// has the piece of each particle, and -1 of one that belongs to none.
  void begin(int pieces, const Eigen::VectorXd& mass, const Eigen::Matrix3Xd& gained,
             const std::vector<int>& piece_of);
  /// So many steps later, in which nothing touched.
  void go_on(int piece, double steps);
  /// In which something touched: `held` are the directions in which a piece is held, and `resting`
  /// is the number of steps in which the rest of its velocity fades to 1/e.
  void go_on(int piece, double steps, const HeldDirections& held, double resting);
  /// How far it went [m].
  Eigen::Vector3d gone(int piece) const;
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  void begin(int pieces);
  bool knows(int piece) const { return piece < gone_.cols(); }

  Eigen::Matrix3Xd speed_, gone_;  // in a step, and so far [m]
  Eigen::VectorXd mass_;           // [kg]
};

}  // namespace pliant
