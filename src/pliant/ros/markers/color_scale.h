#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant {

/// Numbers as colours: dark blue for the least, grey, yellow for the greatest. Brightness only
/// grows, and blue and yellow differ also for those who do not see all colours.
class ColorScale {
 public:
  /// Values beyond [min, max] have the colours of its ends. Where both are equal, the range follows
  /// what occurs, in round numbers: so that on each side all but `tail` of the values are in it,
  /// which a few peaks do not change, widening within a second and narrowing within some more. With
  /// a tail of 0 all values that ever occurred are in it, and it never narrows.
  ColorScale(double min, double max, double tail = 0.0);

  /// Takes the finite values of a picture, n in all, into a range that follows. `time`: of the
  /// simulation [s]. Returns whether the range changed.
  bool follow(std::vector<double> values, double time);
  /// 3 x n, rgb in [0, 1]; of what is not finite white.
  Eigen::Matrix3Xf colors(const Eigen::VectorXd& values) const;
  double min() const { return min_; }
  double max() const { return max_; }

 private:
  void near(double least, double most, double time);
  bool round();

  bool follows_;
  bool is_empty_ = true;  // nothing occurred yet
  double tail_;
  double time_ = 0.0;                // of the last values [s]
  double least_ = 0.0, most_ = 0.0;  // what the range is to show
  double min_, max_;
};

}  // namespace pliant
