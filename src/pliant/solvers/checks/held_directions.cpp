#include "pliant/solvers/checks/held_directions.h"

namespace pliant {
namespace {

// Normals that are nearer to those before hold hardly another direction: a ball on flat ground
// touches it at several points.
constexpr double kLeastSine = 0.3;
// Cosine between normals of fingers that grip a body, at the most.
constexpr double kOpposite = -0.5;

/// The piece that all particles of a constraint belong to; -1 of none, or of several.
int only_piece(const PointConstraints& constraints, const PointConstraint& constraint,
               const std::vector<int>& piece_of) {
  int piece = -1;
  for (int k = constraint.begin; k < constraint.end; ++k) {
    const int particle = constraints.entries[static_cast<std::size_t>(k)].particle;
    const int other = piece_of[static_cast<std::size_t>(particle)];
    if (other < 0) continue;
    if (piece >= 0 && other != piece) return -1;
    piece = other;
  }
  return piece;
}

}  // namespace

void HeldDirections::Span::add(const Eigen::Vector3d& normal) {
  for (int k = 0; k < size; ++k) {
    is_gripped = is_gripped || directions.col(k).dot(normal) < kOpposite;
  }
  if (size == 3) return;
  Eigen::Vector3d rest = normal;
  for (int k = 0; k < size; ++k) rest -= directions.col(k).dot(normal) * directions.col(k);
  const double sine = rest.norm();
  if (sine > kLeastSine) directions.col(size++) = rest / sine;
}

void HeldDirections::find(const PointConstraints& constraints, const std::vector<int>& piece_of,
                          int pieces) {
  spans_.assign(static_cast<std::size_t>(pieces), Span());
  for (const PointConstraint& constraint : constraints.all) {
    if (!(constraint.normal_force > 0.0)) continue;
    const int piece = only_piece(constraints, constraint, piece_of);
    if (piece >= 0) spans_[static_cast<std::size_t>(piece)].add(constraint.normal);
  }
}

void HeldDirections::close_grips(const std::vector<int>& piece_of,
                                 PointConstraints& constraints) const {
  for (PointConstraint& constraint : constraints.all) {
    if (!(constraint.normal_force > 0.0) || !(constraint.gap > 0.0)) continue;
    const int piece = only_piece(constraints, constraint, piece_of);
    if (piece >= 0 && is_gripped(piece)) constraint.gap = 0.0;
  }
}

Eigen::Vector3d HeldDirections::open_part(int piece, const Eigen::Vector3d& drift) const {
  const auto at = static_cast<std::size_t>(piece);
  if (at >= spans_.size()) return drift;
  const auto held = spans_[at].directions.leftCols(spans_[at].size);
  return drift - held * (held.transpose() * drift);
}

bool HeldDirections::is_gripped(int piece) const {
  const auto at = static_cast<std::size_t>(piece);
  return at < spans_.size() && spans_[at].is_gripped;
}

}  // namespace pliant
