#include "pliant/solvers/linear/shared_stiffnesses.h"

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {
constexpr int kGrain = 16, kParticleGrain = 64;
}  // namespace

void SharedStiffnesses::begin_assembly(int particles) {
  begins_.assign(1, 0);
  members_.clear();
  motions_.clear();
  own_.setZero(particles);
  diagonals_.assign(static_cast<std::size_t>(particles), Eigen::Matrix3d::Zero());
}

void SharedStiffnesses::add(const SharedStiffness& shared, const Particles& particles) {
  for (const SharedStiffness::Member& m : shared.members) {
    if (particles.is_fixed(m.particle)) continue;
    members_.push_back({m.particle, m.load});
    own_[m.particle] += m.own;
    diagonals_[static_cast<std::size_t>(m.particle)] += shared.block(m, m);
  }
  motions_.insert(motions_.end(), shared.motions.begin(), shared.motions.end());
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
      places_[static_cast<std::size_t>(--place)] = {s, m};
    }
  }
  answers_.resize(static_cast<std::size_t>(count()));
}

void SharedStiffnesses::add_product(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& y) const {
  parallel_for(0, count(), kGrain, [&](int first, int last) {
    for (int s = first; s < last; ++s) {
      Eigen::Matrix<double, 4, 3> sum = Eigen::Matrix<double, 4, 3>::Zero();  // Σ l vᵀ
      for (int m = begin(s); m < end(s); ++m) {
        const double* column = v.data() + 3 * member(m).particle;
        for (int d = 0; d < 3; ++d) sum.col(d) += column[d] * member(m).load;
      }
      const Motion moved = sum.transpose();
      Motion answer = Motion::Zero();
      for (int k = 0; k < SharedStiffness::kMotions; ++k) {
        answer += motion(s, k).cwiseProduct(moved).sum() * motion(s, k);
      }
      answers_[static_cast<std::size_t>(s)] = answer;
    }
  });
  parallel_for(0, static_cast<int>(diagonals_.size()), kParticleGrain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      Eigen::Vector3d sum = own_[i] * v.col(i);
      for (int p = first_place(i); p < first_place(i + 1); ++p) {
        const Place& place = places_[static_cast<std::size_t>(p)];
        sum -= answers_[static_cast<std::size_t>(place.shared)] * member(place.member).load;
      }
      y.col(i) += sum;
    }
  });
}

double SharedStiffnesses::work() const { return 24.0 * members() + 144.0 * count(); }

}  // namespace pliant
