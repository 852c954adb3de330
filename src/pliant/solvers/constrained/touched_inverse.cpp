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
// A product of c² numbers takes as long as both passes over a factor of so many times fewer
// entries.
constexpr double kEntryShare = 5.0;

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
  const double quicker = std::sqrt(kEntryShare * static_cast<double>(nonzeros));
  most_selected_ = static_cast<std::size_t>(quicker);
  // There are two products of all in a round of contact, beside some twenty of the selected ones.
  const Eigen::Index fitting = kMostNumbers / std::max<Eigen::Index>(1, particles);
  most_touched_ = std::min(3 * most_selected_, static_cast<std::size_t>(fitting));
  column_of_.assign(static_cast<std::size_t>(particles), -1);
  columns_.clear();
  all_ = selected_ = Part();
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

bool TouchedInverse::restrict_to(const std::vector<int>& particles, std::size_t selected) {
  if (particles.size() > most_touched_ || selected > most_selected_) return false;
  const bool is_same = particles == all_.particles;
  if (is_met_ && is_same) return true;
  if (!is_same) keep_columns(particles);
  if (!is_met_) {
    meet_pairs();
    meet_modes();
    sums_.setZero(6, modes_->count());
    motions_.setZero(6, modes_->count());
    for (Eigen::VectorXd* v : {&alphas_, &of_y_, &of_s_}) {
      v->setZero(static_cast<Eigen::Index>(s_p_.size()));
    }
  }
  is_met_ = true;
  if (!is_same) {
    all_.particles = particles;
    fill_matrix(all_);
  }
  fill_pairs(all_);
  find_bodies(all_);
  return true;
}

void TouchedInverse::select(const std::vector<int>& places) {
  const std::size_t all = all_.particles.size(), count = places.size();
  selected_.particles.clear();
  selected_.matrix.resize(count * count);
  for (std::size_t r = 0; r < count; ++r) {
    const auto from = static_cast<std::size_t>(places[r]);
    selected_.particles.push_back(all_.particles[from]);
    const double* row = all_.matrix.data() + from * all;
    for (std::size_t c = 0; c < count; ++c) selected_.matrix[r * count + c] = row[places[c]];
  }
  fill_pairs(selected_);
  find_bodies(selected_);
}

void TouchedInverse::fill_matrix(Part& part) const {
  const std::size_t count = part.particles.size();
  part.matrix.resize(count * count);
  for (std::size_t r = 0; r < count; ++r) {
    const Eigen::VectorXd& from = column(part.particles[r]);
    for (std::size_t c = 0; c < count; ++c) part.matrix[r * count + c] = from[part.particles[c]];
  }
}

void TouchedInverse::fill_pairs(Part& part) const {
  part.s.resize(s_p_.size());
  part.z.resize(z_p_.size());
  const auto gather = [&](const Eigen::Matrix3Xd& whole, Eigen::Matrix4Xd& own) {
    own.setZero(4, static_cast<Eigen::Index>(part.particles.size()));
    for (std::size_t k = 0; k < part.particles.size(); ++k) {
      own.col(static_cast<Eigen::Index>(k)).head<3>() = whole.col(part.particles[k]);
    }
  };
  for (std::size_t k = 0; k < part.s.size(); ++k) {
    gather(pairs_->newest(static_cast<int>(k)).s, part.s[k]);
    gather(pairs_->newest(static_cast<int>(k)).z, part.z[k]);
  }
}

void TouchedInverse::find_bodies(Part& part) const {
  part.bodies.clear();
  for (const int i : part.particles) {
    if (modes_->body_of(i) >= 0) part.bodies.push_back(modes_->body_of(i));
  }
  std::sort(part.bodies.begin(), part.bodies.end());
  part.bodies.erase(std::unique(part.bodies.begin(), part.bodies.end()), part.bodies.end());
}

template <class Visit>
void TouchedInverse::for_members(const Part& part, const Visit& visit) const {
  for (std::size_t c = 0; c < part.particles.size(); ++c) {
    const int body = modes_->body_of(part.particles[c]);
    if (body >= 0) visit(part.particles[c], static_cast<Eigen::Index>(c), body);
  }
}

void TouchedInverse::apply(const Part& part, const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u) {
  const int count = static_cast<int>(part.particles.size());
  u.resize(4, count);
  multiply(count, part.matrix.data(), f.data(), u.data());
  take_out_motions(part, f);
  add_pairs(part, f, u);
  put_in_motions(part, f, u);
}

void TouchedInverse::take_out_motions(const Part& part, const Eigen::Matrix4Xd& f) {
  for (const int b : part.bodies) sums_.col(b).setZero();
  for_members(part, [&](int i, Eigen::Index c, int body) {
    sums_.col(body) += modes_->project(i, f.col(c).head<3>());
  });
  for (const int b : part.bodies) motions_.col(b) = modes_->answer(b, sums_.col(b));
}

double TouchedInverse::along_motions(const Part& part, const Matrix6X& momenta) const {
  double sum = 0.0;
  for (const int b : part.bodies) sum += momenta.col(b).dot(motions_.col(b));
  return sum;
}

void TouchedInverse::add_pairs(const Part& part, const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u) {
  // Between the two loops the forces are f − M P y + Σ of_y y, and after A⁻¹ their answer + Σ of_s
  // s.
  const int pairs = static_cast<int>(part.s.size());
  for (int k = 0; k < pairs; ++k) {
    const auto at = static_cast<std::size_t>(k);
    double along = dot(part.s[at], f) - along_motions(part, s_p_[at]);
    for (int newer = 0; newer < k; ++newer) along += of_y_[newer] * s_y_(k, newer);
    alphas_[k] = pairs_->newest(k).inverse * along;
    of_y_[k] = -alphas_[k];
  }
  for (int k = pairs - 1; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    double along = dot(part.z[at], f) - along_motions(part, z_p_[at]);
    for (int j = 0; j < pairs; ++j) along += of_y_[j] * z_y_(j, k);
    for (int older = k + 1; older < pairs; ++older) along += of_s_[older] * s_y_(older, k);
    of_s_[k] = alphas_[k] - pairs_->newest(k).inverse * along;
  }
  for (int k = 0; k < pairs; ++k) {
    const auto at = static_cast<std::size_t>(k);
    u += of_y_[k] * part.z[at] + of_s_[k] * part.s[at];
  }
}

void TouchedInverse::put_in_motions(const Part& part, const Eigen::Matrix4Xd& f,
                                    Eigen::Matrix4Xd& u) {
  // sums_ becomes the momentum of u, as all of the body would have it.
  for (const int b : part.bodies) {
    sums_.col(b) = -p_p_[static_cast<std::size_t>(b)] * motions_.col(b);
  }
  for_members(part, [&](int i, Eigen::Index c, int body) {
    const Eigen::Vector3d own = f.col(c).head<3>();
    sums_.col(body).head<3>() += to_mass_(0, i) * own;
    sums_.col(body).tail<3>() += Eigen::Vector3d(to_arm_.col(i)).cross(own);
    u.col(c).head<3>() -= answer_to_momentum(i, motions_.col(body));
  });
  for (std::size_t k = 0; k < part.s.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    for (const int b : part.bodies) {
      sums_.col(b) += of_y_[at] * z_p_[k].col(b) + of_s_[at] * s_p_[k].col(b);
    }
  }
  for (const int b : part.bodies) motions_.col(b) -= modes_->answer(b, sums_.col(b));
  for_members(part, [&](int i, Eigen::Index c, int body) {
    u.col(c).head<3>() += modes_->motion(i, motions_.col(body));
  });
}

}  // namespace pliant
