#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pliant {

/// Samples of a surface, in spacings: a grid covers within kSampleGrid / √3 of each place; leaving
/// out what is nearer than kSampleDistance to another sample adds that: together below one spacing.
constexpr double kSampleGrid = 0.75;
constexpr double kSampleDistance = 0.5;

/// Keeps points that are not too near to those kept before.
class SpacedPoints {
 public:
  /// `least` > 0: the least distance [m].
  explicit SpacedPoints(double least) : least_(least) {}

  /// Whether p is at least that far from every point kept; false leaves it out.
  bool keep(const Eigen::Vector3d& p);
  /// Keeps p wherever it is.
  void force(const Eigen::Vector3d& p);

 private:
  using Cell = Eigen::Matrix<std::int64_t, 3, 1>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const;
  };

  Cell cell_of(const Eigen::Vector3d& p) const;

  double least_;
  std::unordered_map<Cell, std::vector<Eigen::Vector3d>, Hash> kept_;
};

}  // namespace pliant
