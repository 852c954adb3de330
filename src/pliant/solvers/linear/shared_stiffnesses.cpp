#include "pliant/solvers/linear/shared_stiffnesses.h"

#include <cstring>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

constexpr int kGrain = 16, kParticleGrain = 64;
// Four numbers: a member's load; or a column of a motion, and one behind it that nothing uses.
using Four = double __attribute__((vector_size(32)));
constexpr int kNumbers = 12;  // of a motion

/// Σ l vᵀ of the members from `begin` to `end`, 4 x 3.
PLIANT_WIDEST void sum_loads(const SharedStiffnesses::Member* begin,
                             const SharedStiffnesses::Member* end, const double* v, double* sums) {
  Four sum[3] = {};
  for (const auto* member = begin; member != end; ++member) {
    const double* column = v + 3 * static_cast<std::ptrdiff_t>(member->particle);
    Four load;
    std::memcpy(&load, member->load.data(), sizeof load);
    for (int d = 0; d < 3; ++d) sum[d] += column[d] * load;
  }
  std::memcpy(sums, sum, sizeof sum);
}

/// Takes A l of each place off the sum: A are the answers of its shared stiffness, l is its load.
PLIANT_WIDEST void take_answers(const SharedStiffnesses::Place* begin,
                                const SharedStiffnesses::Place* end, const double* answers,
                                double* sum) {
  Four left = {sum[0], sum[1], sum[2], 0.0};
  for (const auto* place = begin; place != end; ++place) {
    const double* answer = answers + kNumbers * static_cast<std::ptrdiff_t>(place->shared);
    const double* load = place->load.data();
    Four columns[4];
    for (int k = 0; k < 4; ++k) std::memcpy(&columns[k], answer + 3 * k, sizeof columns[k]);
    left -= (columns[0] * load[0] + columns[1] * load[1]) +
            (columns[2] * load[2] + columns[3] * load[3]);
  }
  for (int d = 0; d < 3; ++d) sum[d] = left[d];
}

/// Σ a b over all entries, four sums side by side.
double inner_product(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const auto product = [&](int k) { return a.data()[k] * b.data()[k]; };
  const double even = (product(0) + (product(2) + product(4))) + (product(6) + product(8));
  const double odd = (product(1) + (product(3) + product(5))) + product(7);
  return even + odd;
}

}  // namespace

void SharedStiffnesses::begin_assembly(int particles) {
  begins_.assign(1, 0);
  members_.clear();
  pulls_.clear();
  moves_.clear();
  turns_.clear();
  own_.setZero(particles);
  diagonals_.assign(static_cast<std::size_t>(particles), Eigen::Matrix3d::Zero());
}

void SharedStiffnesses::add(const SharedStiffness& shared, const Particles& particles) {
  for (const SharedStiffness::Member& m : shared.members) {
    if (particles.is_fixed(m.particle)) continue;
    members_.push_back({m.particle, m.load});
    own_[m.particle] += m.own;
    const SharedStiffness::Pulls& pulls = pulls_.emplace_back(shared.pulls(m));
    diagonals_[static_cast<std::size_t>(m.particle)] += SharedStiffness::block(pulls, pulls, m.own);
  }
  moves_.push_back(shared.move);
  turns_.push_back(shared.turns);
  begins_.push_back(members());
}

void SharedStiffnesses::finish() {
  const std::size_t particles = diagonals_.size();
  places_at_.assign(particles + 1, 0);
  for (const Member& m : members_) ++places_at_[static_cast<std::size_t>(m.particle) + 1];
  for (std::size_t i = 1; i <= particles; ++i) places_at_[i] += places_at_[i - 1];
  places_.resize(members_.size());
  // Filled from the back, so that the ends of particles become their beginnings.
  for (std::size_t i = 0; i < particles; ++i) places_at_[i] = places_at_[i + 1];
  for (int s = count() - 1; s >= 0; --s) {
    for (int m = end(s) - 1; m >= begin(s); --m) {
      int& place = places_at_[static_cast<std::size_t>(member(m).particle)];
      places_[static_cast<std::size_t>(--place)] = {s, member(m).load};
    }
  }
  answers_.resize(static_cast<std::size_t>(count()) + 1);
}

void SharedStiffnesses::add_product(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& y) const {
  if (members_.empty()) return;
  parallel_for(0, count(), kGrain, [&](int first, int last) {
    for (int s = first; s < last; ++s) {
      Eigen::Matrix<double, 4, 3> sum;
      sum_loads(&members_[0] + begin(s), &members_[0] + end(s), v.data(), sum.data());
      const Eigen::Matrix3d moments = sum.topRows<3>().transpose();
      Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
      for (const Eigen::Matrix3d& turn : turns_[static_cast<std::size_t>(s)]) {
        turned += inner_product(turn, moments) * turn;
      }
      auto& answer = answers_[static_cast<std::size_t>(s)];
      answer.leftCols<3>() = turned;
      const double move = moves_[static_cast<std::size_t>(s)];
      for (int d = 0; d < 3; ++d) answer(d, 3) = move * sum(3, d) * move;
    }
  });
  parallel_for(0, static_cast<int>(diagonals_.size()), kParticleGrain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      Eigen::Vector3d sum = own_[i] * v.col(i);
      take_answers(&places_[0] + first_place(i), &places_[0] + first_place(i + 1),
                   answers_.front().data(), sum.data());
      y.col(i) += sum;
    }
  });
}

double SharedStiffnesses::work() const { return 24.0 * members() + 144.0 * count(); }

}  // namespace pliant
