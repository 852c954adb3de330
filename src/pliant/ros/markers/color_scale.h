#pragma once

#include <Eigen/Core>

namespace pliant {

/// Numbers as colours: dark blue for the least, grey, yellow for the greatest. Brightness only
/// grows, and blue and yellow differ also for those who do not see all colours.
class ColorScale {
 public:
  /// Values beyond [min, max] have the colours of its ends. Where both are equal, the range follows
  /// what occurs: it widens, in round numbers, and never narrows.
  ColorScale(double min, double max);

  /// Takes finite values into a range that follows; returns whether the range changed.
  bool include(const Eigen::VectorXd& values);
  /// 3 x n, rgb in [0, 1]; of what is not finite white.
  Eigen::Matrix3Xf colors(const Eigen::VectorXd& values) const;
  double min() const { return min_; }
  double max() const { return max_; }

 private:
  bool follows_;
  bool is_empty_ = true;             // nothing occurred yet
  double least_ = 0.0, most_ = 0.0;  // of what occurred
  double min_, max_;
};

}  // namespace pliant
