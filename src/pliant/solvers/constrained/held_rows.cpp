#include "pliant/solvers/constrained/held_rows.h"

#include <algorithm>

namespace pliant {
namespace {
// Rows for each particle, beyond which a product with their block takes less work: an entry of a
// row is read twice, and of a block there are as many as particles for each of these.
constexpr double kRowsPerParticle = 1.5;
}  // namespace

bool HeldRows::hold_the_same(int row, int other) const {
  return std::equal(begin(row), end(row), begin(other), end(other),
                    [](const Entry& a, const Entry& b) { return a.particle == b.particle; });
}

void HeldRows::merge() {
  blocks_.clear();
  stiffnesses_.clear();
  for (int first = 0; first < size();) {
    int last = first + 1;
    while (last < size() && hold_the_same(first, last)) ++last;
    const int particles = entries(first);
    if (particles > 0 && last - first > kRowsPerParticle * particles) append_block(first, last);
    first = last;
  }
}

void HeldRows::append_block(int first, int last) {
  const Block block = {first, last, entries(first), stiffnesses_.size()};
  const int n = block.particles;
  stiffnesses_.resize(block.stiffnesses + static_cast<std::size_t>(n * n), Eigen::Matrix3d::Zero());
  for (int row = first; row < last; ++row) {
    const Entry* entry = begin(row);
    for (int a = 0; a < n; ++a) {
      const Eigen::Vector3d pull = stiffness(row) * entry[a].gradient;
      for (int b = 0; b <= a; ++b) {
        stiffnesses_[block.of(a, b)].noalias() += pull * entry[b].gradient.transpose();
      }
    }
  }
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < a; ++b) {
      stiffnesses_[block.of(b, a)] = stiffnesses_[block.of(a, b)].transpose();
    }
  }
  blocks_.push_back(block);
}

void HeldRows::add_product(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& f) const {
  for_each([&](int row) { add_scaled(row, stiffness(row) * along(row, v), f); },
           [&](const Block& block) {
             const Entry* entry = begin(block.first);
             for (int a = 0; a < block.particles; ++a) {
               Eigen::Vector3d sum = f.col(entry[a].particle);
               for (int b = 0; b < block.particles; ++b) {
                 sum.noalias() += stiffness(block, a, b) * v.col(entry[b].particle);
               }
               f.col(entry[a].particle) = sum;
             }
           });
}

void HeldRows::add_diagonal(std::vector<Eigen::Matrix3d>& diagonal) const {
  const auto of = [&](int particle) -> Eigen::Matrix3d& {
    return diagonal[static_cast<std::size_t>(particle)];
  };
  for_each(
      [&](int row) {
        for (const Entry* e = begin(row); e != end(row); ++e) {
          of(e->particle) += stiffness(row) * e->gradient * e->gradient.transpose();
        }
      },
      [&](const Block& block) {
        for (int a = 0; a < block.particles; ++a) {
          of(particle(block, a)) += stiffness(block, a, a);
        }
      });
}

}  // namespace pliant
