#pragma once

#include <vector>

namespace pliant {

/// Which columns of a sparse factor L have to be known before which: the parent of a column is the
/// one of its first row below the diagonal, and only the columns above it in the tree know it.
class EliminationTree {
 public:
  /// `columns`: of each column of L the rows below its diagonal, in order.
  explicit EliminationTree(const std::vector<std::vector<int>>& columns);

  /// New numbers of the columns in which parents go on to come after their children: those of a
  /// first group of subtrees, from `first` on those of a second one, from `second` on all others.
  struct Groups {
    std::vector<int> number_of;  ///< of each column
    int first = 0, second = 0;
  };
  /// Two groups of about the same work, with little left after both. Where two threads would save
  /// little by them, all columns are in the first one.
  Groups split() const;

 private:
  /// Subtrees, by their roots, in two groups.
  struct Choice {
    std::vector<int> roots;
    std::vector<bool> is_second;  // of each root
    double longest = 0.0;         // work of what has to be done one after the other
  };
  Choice share_out(std::vector<int> roots, double above) const;
  Groups number(const Choice& choice) const;

  std::vector<int> parent_;  // -1: none
  std::vector<std::vector<int>> children_;
  std::vector<double> work_;  // of a column's subtree
  double whole_ = 0.0;
};

}  // namespace pliant
