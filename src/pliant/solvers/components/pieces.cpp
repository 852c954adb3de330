#include "pliant/solvers/components/pieces.h"

#include <algorithm>
#include <numeric>

namespace pliant {
namespace {

/// Pieces of one component each, and then that of loose particles.
int count_pieces(const Components& components) {
  int count = 1;
  for (int c = 0; c < components.count(); ++c) {
    const auto at = static_cast<std::size_t>(c);
    if (components.begins[at + 1] - components.begins[at] > 1) ++count;
  }
  return count;
}

}  // namespace

std::vector<int> Pieces::of_particles(const Components& components) {
  std::vector<int> piece_of(static_cast<std::size_t>(components.count()));
  const int loose = count_pieces(components) - 1;
  int next = 0;
  for (std::size_t c = 0; c < piece_of.size(); ++c) {
    const bool is_loose = components.begins[c + 1] - components.begins[c] == 1;
    piece_of[c] = is_loose ? loose : next++;
  }
  std::vector<int> of = components.of;
  for (int& piece : of) {
    piece = piece == Components::kNone ? kNone : piece_of[static_cast<std::size_t>(piece)];
  }
  return of;
}

Pieces::Pieces(const Components& components, const Eigen::VectorXd& mass) {
  const std::vector<int> of = of_particles(components);
  mass_shares_.assign(static_cast<std::size_t>(count_pieces(components)), 0.0);
  begins_.assign(mass_shares_.size() + 1, 0);
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (of[i] == kNone) continue;
    ++begins_[static_cast<std::size_t>(of[i]) + 1];
    mass_shares_[static_cast<std::size_t>(of[i])] += mass[static_cast<Eigen::Index>(i)];
  }
  const double whole = std::accumulate(mass_shares_.begin(), mass_shares_.end(), 0.0);
  if (whole > 0.0) {
    for (double& share : mass_shares_) share /= whole;
  }
  if (std::count(begins_.begin() + 1, begins_.end(), 0) + 1 >= count()) {
    begins_.clear();
    return;
  }
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  members_.resize(static_cast<std::size_t>(begins_.back()));
  std::vector<int> next(begins_.begin(), begins_.end() - 1);
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (of[i] == kNone) continue;
    members_[static_cast<std::size_t>(next[static_cast<std::size_t>(of[i])]++)] =
        static_cast<int>(i);
  }
}

}  // namespace pliant
