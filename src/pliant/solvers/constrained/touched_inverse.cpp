#include "pliant/solvers/constrained/touched_inverse.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "pliant/math/widest.h"
#include "pliant/solvers/linear/vector_products.h"

namespace pliant {
namespace {

// Numbers of the columns that a restriction needs: 32 MB at the most, and as much is kept besides.
constexpr Eigen::Index kMostNumbers = 4'000'000;

using Four = double __attribute__((vector_size(4 * sizeof(double))));

/// u = G f of n columns of 4 numbers.
PLIANT_WIDEST void multiply(int n, const double* g, const double* f, double* u) {
  const auto at = [](const double* v, int column) {
    Four four;
    std::memcpy(&four, v + 4 * static_cast<std::ptrdiff_t>(column), sizeof four);
    return four;
  };
  const auto put = [u](const Four& four, int column) {
    std::memcpy(u + 4 * static_cast<std::ptrdiff_t>(column), &four, sizeof four);
  };
  int i = 0;
  for (; i + 4 <= n; i += 4) {
    const double* row = g + static_cast<std::ptrdiff_t>(i) * n;
    Four sum0 = {}, sum1 = {}, sum2 = {}, sum3 = {};
    for (int j = 0; j < n; ++j) {
      const Four x = at(f, j);
      sum0 += row[j] * x;
      sum1 += row[n + j] * x;
      sum2 += row[2 * n + j] * x;
      sum3 += row[3 * n + j] * x;
    }
    put(sum0, i);
    put(sum1, i + 1);
    put(sum2, i + 2);
    put(sum3, i + 3);
  }
  for (; i < n; ++i) {
    const double* row = g + static_cast<std::ptrdiff_t>(i) * n;
    Four sum = {};
    for (int j = 0; j < n; ++j) sum += row[j] * at(f, j);
    put(sum, i);
  }
}

double dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return dot_product(a.size(), a.data(), b.data());
}

double dot(const Eigen::Matrix4Xd& a, const Eigen::Matrix4Xd& b) {
  return dot_product(a.size(), a.data(), b.data());
}

}  // namespace

void TouchedInverse::prepare(Eigen::Index particles, Eigen::Index nonzeros,
                             LinearOperator a_inverse) {
  a_inverse_ = std::move(a_inverse);
  // A product of c² numbers takes as long as both passes over the factor where c² is twice its
  // entries.
  const double quicker = std::sqrt(2.0 * static_cast<double>(nonzeros));
  const Eigen::Index fitting = kMostNumbers / std::max<Eigen::Index>(1, particles);
  most_touched_ = static_cast<std::size_t>(std::min(quicker, static_cast<double>(fitting)));
  column_of_.assign(static_cast<std::size_t>(particles), -1);
  columns_.clear();
  matrix_.clear();
  is_mass_met_ = false;
}

template <class Visit>
void TouchedInverse::solve_columns(const std::vector<int>& particles, const Visit& visit) {
  // One solution has three sides.
  for (std::size_t k = 0; k < particles.size(); k += 3) {
    const int count = static_cast<int>(std::min<std::size_t>(3, particles.size() - k));
    sides_.setZero(3, static_cast<Eigen::Index>(column_of_.size()));
    for (int c = 0; c < count; ++c) sides_(c, particles[k + static_cast<std::size_t>(c)]) = 1.0;
    a_inverse_(sides_);
    for (int c = 0; c < count; ++c) visit(particles[k + static_cast<std::size_t>(c)], c);
  }
}

const std::vector<double>& TouchedInverse::own(const std::vector<int>& particles) {
  own_.clear();
  solve_columns(particles, [&](int i, int c) { own_.push_back(sides_(c, i)); });
  return own_;
}

void TouchedInverse::keep_columns(const std::vector<int>& particles) {
  const auto find_unknown = [&] {
    unknown_.clear();
    for (const int i : particles) {
      if (!knows_column(i)) unknown_.push_back(i);
    }
  };
  find_unknown();
  // Twice as many as are needed at once: those that come and go are not asked for each time.
  if (columns_.size() + unknown_.size() > 2 * most_touched_) {
    columns_.clear();
    std::fill(column_of_.begin(), column_of_.end(), -1);
    find_unknown();
  }
  solve_columns(unknown_, [&](int i, int c) {
    column_of_[static_cast<std::size_t>(i)] = static_cast<int>(columns_.size());
    columns_.push_back(sides_.row(c));
  });
}

void TouchedInverse::begin_correction(const RigidModes& modes, QuasiNewtonPairs* pairs) {
  modes_ = &modes;
  pairs_ = pairs;
  is_met_ = false;
}

void TouchedInverse::meet_pairs() {
  const int count = pairs_ == nullptr ? 0 : pairs_->size();
  s_y_.resize(count, count);
  z_y_.resize(count, count);
  for (int k = 0; k < count; ++k) {
    QuasiNewtonPairs::Pair& pair = pairs_->newest(k);
    if (pair.z.cols() > 0) continue;
    pair.z = pair.y;
    a_inverse_(pair.z);
  }
  for (int j = 0; j < count; ++j) {
    for (int k = 0; k < count; ++k) {
      s_y_(j, k) = dot(pairs_->newest(j).s, pairs_->newest(k).y);
      z_y_(j, k) = dot(pairs_->newest(j).z, pairs_->newest(k).y);
    }
  }
  s_p_.resize(static_cast<std::size_t>(count));
  z_p_.resize(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    modes_->momenta(pairs_->newest(k).s, s_p_[static_cast<std::size_t>(k)]);
    modes_->momenta(pairs_->newest(k).z, z_p_[static_cast<std::size_t>(k)]);
  }
}

void TouchedInverse::meet_modes() {
  const auto n = static_cast<Eigen::Index>(column_of_.size());
  p_p_.assign(static_cast<std::size_t>(modes_->count()), RigidModes::Matrix6::Zero());
  if (modes_->count() == 0) return;
  to_arm_.setZero(3, n);
  for (int i = 0; i < n; ++i) {
    if (modes_->body_of(i) >= 0) to_arm_.col(i) = modes_->inertia_of(i) * modes_->arm(i);
  }
  a_inverse_(to_arm_);
  if (!is_mass_met_) {
    is_mass_met_ = true;
    to_mass_.setZero(3, n);
    for (int i = 0; i < n; ++i) {
      if (modes_->body_of(i) >= 0) to_mass_(0, i) = modes_->inertia_of(i);
    }
    a_inverse_(to_mass_);
  }
  for (int i = 0; i < n; ++i) {
    const int body = modes_->body_of(i);
    if (body < 0) continue;
    RigidModes::Matrix6& own = p_p_[static_cast<std::size_t>(body)];
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d moved = answer_to_momentum(i, Vector6::Unit(k));
      own.col(k) += modes_->project(i, modes_->inertia_of(i) * moved);
    }
  }
}

Eigen::Vector3d TouchedInverse::answer_to_momentum(int particle, const Vector6& y) const {
  // A acts on each coordinate alone, so that three arms tell all rotations.
  return to_mass_(0, particle) * y.head<3>() +
         Eigen::Vector3d(y.tail<3>()).cross(Eigen::Vector3d(to_arm_.col(particle)));
}

void TouchedInverse::gather(const Eigen::Matrix3Xd& whole, Eigen::Matrix4Xd& part) const {
  part.setZero(4, static_cast<Eigen::Index>(particles_.size()));
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    part.col(static_cast<Eigen::Index>(k)).head<3>() = whole.col(particles_[k]);
  }
}

bool TouchedInverse::restrict_to(const std::vector<int>& particles) {
  if (particles.size() > most_touched_) return false;
  const auto count = static_cast<Eigen::Index>(particles.size());
  const bool is_same = particles == particles_ && !matrix_.empty();
  if (is_met_ && is_same) return true;
  keep_columns(particles);
  if (!is_met_) {
    meet_pairs();
    meet_modes();
  }
  is_met_ = true;
  particles_ = particles;
  fill_matrix();
  fill_pairs();
  find_bodies();
  return true;
}

void TouchedInverse::fill_matrix() {
  const std::size_t count = particles_.size();
  matrix_.resize(count * count);
  for (std::size_t r = 0; r < count; ++r) {
    const Eigen::VectorXd& from = column(particles_[r]);
    for (std::size_t c = 0; c < count; ++c) matrix_[r * count + c] = from[particles_[c]];
  }
}

void TouchedInverse::fill_pairs() {
  s_.resize(s_p_.size());
  z_.resize(z_p_.size());
  for (std::size_t k = 0; k < s_.size(); ++k) {
    gather(pairs_->newest(static_cast<int>(k)).s, s_[k]);
    gather(pairs_->newest(static_cast<int>(k)).z, z_[k]);
  }
  for (Eigen::VectorXd* v : {&alphas_, &of_y_, &of_s_}) {
    v->setZero(static_cast<Eigen::Index>(s_.size()));
  }
}

void TouchedInverse::find_bodies() {
  sums_.setZero(6, modes_->count());
  motions_.setZero(6, modes_->count());
  bodies_.clear();
  for (const int i : particles_) {
    if (modes_->body_of(i) >= 0) bodies_.push_back(modes_->body_of(i));
  }
  std::sort(bodies_.begin(), bodies_.end());
  bodies_.erase(std::unique(bodies_.begin(), bodies_.end()), bodies_.end());
}

template <class Visit>
void TouchedInverse::for_members(const Visit& visit) const {
  for (std::size_t c = 0; c < particles_.size(); ++c) {
    const int body = modes_->body_of(particles_[c]);
    if (body >= 0) visit(particles_[c], static_cast<Eigen::Index>(c), body);
  }
}

void TouchedInverse::apply(const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u) {
  const int count = static_cast<int>(particles_.size());
  u.resize(4, count);
  multiply(count, matrix_.data(), f.data(), u.data());
  take_out_motions(f);
  add_pairs(f, u);
  put_in_motions(f, u);
}

void TouchedInverse::take_out_motions(const Eigen::Matrix4Xd& f) {
  for (const int b : bodies_) sums_.col(b).setZero();
  for_members([&](int i, Eigen::Index c, int body) {
    sums_.col(body) += modes_->project(i, f.col(c).head<3>());
  });
  for (const int b : bodies_) motions_.col(b) = modes_->answer(b, sums_.col(b));
}

double TouchedInverse::along_motions(const Matrix6X& momenta) const {
  double sum = 0.0;
  for (const int b : bodies_) sum += momenta.col(b).dot(motions_.col(b));
  return sum;
}

void TouchedInverse::add_pairs(const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u) {
  // Between the two loops the forces are f − M P y + Σ of_y y, and after A⁻¹ their answer + Σ of_s
  // s.
  const int pairs = static_cast<int>(s_.size());
  for (int k = 0; k < pairs; ++k) {
    const auto at = static_cast<std::size_t>(k);
    double along = dot(s_[at], f) - along_motions(s_p_[at]);
    for (int newer = 0; newer < k; ++newer) along += of_y_[newer] * s_y_(k, newer);
    alphas_[k] = pairs_->newest(k).inverse * along;
    of_y_[k] = -alphas_[k];
  }
  for (int k = pairs - 1; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    double along = dot(z_[at], f) - along_motions(z_p_[at]);
    for (int j = 0; j < pairs; ++j) along += of_y_[j] * z_y_(j, k);
    for (int older = k + 1; older < pairs; ++older) along += of_s_[older] * s_y_(older, k);
    of_s_[k] = alphas_[k] - pairs_->newest(k).inverse * along;
  }
  for (int k = 0; k < pairs; ++k) {
    const auto at = static_cast<std::size_t>(k);
    u += of_y_[k] * z_[at] + of_s_[k] * s_[at];
  }
}

void TouchedInverse::put_in_motions(const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u) {
  // sums_ becomes the momentum of u, as all of the body would have it.
  for (const int b : bodies_) sums_.col(b) = -p_p_[static_cast<std::size_t>(b)] * motions_.col(b);
  for_members([&](int i, Eigen::Index c, int body) {
    const Eigen::Vector3d own = f.col(c).head<3>();
    sums_.col(body).head<3>() += to_mass_(0, i) * own;
    sums_.col(body).tail<3>() += Eigen::Vector3d(to_arm_.col(i)).cross(own);
    u.col(c).head<3>() -= answer_to_momentum(i, motions_.col(body));
  });
  for (std::size_t k = 0; k < s_.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    for (const int b : bodies_) {
      sums_.col(b) += of_y_[at] * z_p_[k].col(b) + of_s_[at] * s_p_[k].col(b);
    }
  }
  for (const int b : bodies_) motions_.col(b) -= modes_->answer(b, sums_.col(b));
  for_members([&](int i, Eigen::Index c, int body) {
    u.col(c).head<3>() += modes_->motion(i, motions_.col(body));
  });
}

}  // namespace pliant
