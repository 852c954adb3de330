#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "pliant/core/system/element_set.h"

namespace pliant {

/// A symmetric matrix of 3x3 blocks, n x n, whose rows and columns are particles. It keeps its
/// pattern from one assembly to the next, so that assembling anew allocates nothing.
class BlockMatrix final : public StiffnessMatrix {
 public:
  /// Begins an assembly: blocks of `inertia` [N/m] on the diagonal, and nothing else. Rows and
  /// columns of pinned particles stay those of the identity times their inertia.
  void begin(const Particles& particles, const Eigen::VectorXd& inertia);
  void add(int row, int column, const Eigen::Matrix3d& block) override;
  /// Ends it. False: there were blocks that the pattern had no place for; it has now, and all of
  /// the assembly has to be done again.
  bool finish();

  int size() const { return static_cast<int>(begins_.size()) - 1; }
  int begin(int row) const { return begins_[static_cast<std::size_t>(row)]; }
  int end(int row) const { return begins_[static_cast<std::size_t>(row) + 1]; }
  int column(int entry) const { return columns_[static_cast<std::size_t>(entry)]; }
  const Eigen::Matrix3d& block(int entry) const { return blocks_[static_cast<std::size_t>(entry)]; }
  const Eigen::Matrix3d& diagonal(int row) const {
    return blocks_[static_cast<std::size_t>(diagonals_[static_cast<std::size_t>(row)])];
  }
  /// y = A v, both 3 x n.
  void multiply(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& y) const;

 private:
  int find(int row, int column) const;
  void widen_pattern();

  const Particles* particles_ = nullptr;  // of the running assembly
  std::vector<int> begins_ = {0}, columns_, diagonals_;
  std::vector<Eigen::Matrix3d> blocks_;  // and one more, which products read beyond the last
  std::vector<int> found_;  // where each block of an assembly went, in the order of add()
  std::size_t added_ = 0;   // of the running assembly
  std::vector<std::pair<int, int>> strays_;  // rows and columns that the pattern lacks
};

}  // namespace pliant
