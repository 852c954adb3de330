#include "pliant/solvers/linear/hessian_solver.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pliant/core/columns.h"

namespace pliant {
namespace {

constexpr int kMostIterations = 1000;
constexpr double kRoundOff = 1e-12;
// What another factor of the coarse space costs about: iterations with that of other rows are tried
// for as long.
constexpr int kPatience = 16;
// Of the whole's dᵀ A d, and of its share by a piece's mass: what a piece that hardly moves may
// miss is compared with.
constexpr double kLeastShare = 1e-4;
// Particles whose matrix is factored; the factor of a solid of many more takes too much memory.
constexpr int kMostFactored = 3000;

// Columns that are summed one after the other; and how many of these a thread takes at the least.
constexpr int kRun = 256, kRunsOfAThread = 4;

}  // namespace

template <class Term>
double HessianSolver::sum_columns(const Term& term) {
  const int n = matrix_.size(), runs = (n + kRun - 1) / kRun;
  if (sums_.size() != runs) sums_.resize(runs);
  parallel_for(0, runs, kRunsOfAThread, [&](int first, int last) {
    for (int run = first; run < last; ++run) {
      const int end = std::min(n, (run + 1) * kRun);
      double sum = 0.0;
      for (int i = run * kRun; i < end; ++i) sum += term(i);
      sums_[run] = sum;
    }
  });
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) sum += sums_[run];
  return sum;
}

double HessianSolver::dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return sum_columns([&](int i) { return a.col(i).dot(b.col(i)); });
}

void HessianSolver::begin_step(bool may_factor, bool ties_rows) {
  pairs_.forget();
  ties_rows_ = ties_rows;
  if (is_prepared_) coarse_.begin_step(ties_rows);
  pairs_state_ = kNone;
  may_factor_ = may_factor;
}

void HessianSolver::assemble(const ProjectiveSystem& system, const Positions& x,
                             const Eigen::VectorXd& inertia, Definiteness definiteness) {
  const Particles& particles = system.particles;
  if (!is_prepared_) matrix_ = BlockMatrix();
  do {
    matrix_.begin(particles, inertia);
    for (const auto& set : system.elements) set->add_stiffness(x, definiteness, matrix_);
  } while (!matrix_.finish());
  parallel_copy(x, x_);
  coarse_state_ = kNone;
  if (pairs_state_ == kFresh) pairs_state_ = kOfOtherRows;
  is_definite_ = definiteness == Definiteness::kProjected;
  if (!is_prepared_) {
    coarse_.prepare(matrix_, particles);
    coarse_.begin_step(ties_rows_);
    if (can_factor()) pairs_.prepare(matrix_);
    pairs_state_ = kNone;
    const Components components = find_components(system);
    pieces_ = Pieces(components, particles.mass);
    balance_.prepare(components, inertia);
    for (Eigen::VectorXd* v : {&squared_, &largest_, &added_, &last_added_, &none_}) {
      v->setZero(pieces_.count());
    }
  }
  balance_.place(inertia, 1.0, x);
  inverses_.resize(static_cast<std::size_t>(particles.size()));
  is_prepared_ = true;
}

bool HessianSolver::can_factor() const {
  return matrix_.size() <= kMostFactored && matrix_.shared().count() == 0;
}

void HessianSolver::use_rows() {
  const int n = matrix_.size();
  for (int i = 0; i < n; ++i) inverses_[static_cast<std::size_t>(i)] = matrix_.diagonal(i);
  rows_.merge();
  rows_.add_diagonal(inverses_);
  parallel_for(0, n, kLoopGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      Eigen::Matrix3d& inverse = inverses_[static_cast<std::size_t>(i)];
      inverse = inverse.inverse().eval();
    }
  });
  balance_.factor(rows_);
  if (coarse_state_ == kFresh) coarse_state_ = kOfOtherRows;
  if (pairs_state_ == kFresh) pairs_state_ = kOfOtherRows;
}

void HessianSolver::find_own_answers(const Eigen::VectorXd& inertia,
                                     std::vector<Eigen::Matrix3d>& answers) const {
  answers.resize(static_cast<std::size_t>(matrix_.size()));
  parallel_for(0, matrix_.size(), kLoopGrain, [&](int begin, int end) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes;
    for (int i = begin; i < end; ++i) {
      modes.computeDirect(matrix_.diagonal(i));
      // Inertia is the least that resists, also where the matrix is not positive definite.
      const Eigen::Vector3d own = modes.eigenvalues().cwiseMax(inertia[i]).cwiseInverse();
      answers[static_cast<std::size_t>(i)] =
          modes.eigenvectors() * own.asDiagonal() * modes.eigenvectors().transpose();
    }
  });
}

void HessianSolver::balance(Eigen::Matrix3Xd& v) {
  none_.setZero();
  parallel_copy(residual_, direction_);
  if (!balance_.find_motion(direction_)) return;
  sum_pieces(direction_, residual_, none_);
  // What rigid motions take of dᵀ A d dwarfs what stiff bodies feel, contact forces among it: it
  // is no measure of what is left.
  none_ = kRoundOff * kRoundOff * none_.cwiseMax(0.0);
  multiply(direction_, product_);
  rows_.add_product(direction_, product_);
  for_each_column(v, [&](int i) {
    v.col(i) += direction_.col(i);
    residual_.col(i) -= product_.col(i);
  });
}

void HessianSolver::sum_pieces(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b,
                               Eigen::VectorXd& sums) {
  if (pieces_.are_one()) {
    sums.setConstant(dot(a, b));
  } else {
    pieces_.sum([&](int i) { return a.col(i).dot(b.col(i)); }, sums);
  }
}

void HessianSolver::add_progress(double step, double curvature) {
  last_added_ = added_;
  if (pieces_.are_one()) {
    added_.setConstant(curvature);
  } else {
    sum_pieces(direction_, product_, added_);
  }
  added_ *= step * step;
  squared_ += added_;
}

bool HessianSolver::adds_little(double tolerance) const {
  // What an iteration adds to dᵀ A d is what it takes from the error (Hestenes and Stiefel 1952,
  // theorem 6:1); the mean of two, since one may add little by chance.
  const double whole = pieces_.are_one() ? squared_[0] : squared_.sum();
  for (int k = 0; k < pieces_.count(); ++k) {
    if (pieces_.mass_share(k) == 0.0) continue;
    const double reference =
        std::max({largest_[k], squared_[k], kLeastShare * pieces_.mass_share(k) * whole});
    const double limit = std::max(tolerance * tolerance * reference, none_[k]);
    if (!(0.5 * std::abs(added_[k] + last_added_[k]) <= limit)) return false;
  }
  return true;
}

void HessianSolver::factor_coarse() {
  coarse_.factor(matrix_, rows_, x_);
  coarse_state_ = kFresh;
}

double HessianSolver::precondition() {
  const Eigen::Matrix3Xd& r = residual_;
  Eigen::Matrix3Xd& z = preconditioned_;
  z.resize(3, r.cols());
  if (pairs_state_ != kNone) {
    pairs_.solve(r, z);
    return dot(r, z);
  }
  coarse_.solve(r);
  return sum_columns([&](int i) {
    const Eigen::Vector3d own = inverses_[static_cast<std::size_t>(i)] * r.col(i);
    z.col(i) = own + coarse_.correction(i);
    return r.col(i).dot(z.col(i));
  });
}

int HessianSolver::price_of_factor() {
  pairs_.analyze(matrix_, rows_);
  const double levels = pairs_state_ == kNone ? coarse_.work() : pairs_.work_of_solve();
  return static_cast<int>(pairs_.work_of_factor() / (matrix_.work() + levels));
}

bool HessianSolver::factor_pairs() {
  if (pairs_.factor(matrix_, rows_)) {
    pairs_state_ = kFresh;
    return true;
  }
  pairs_state_ = kNone;
  // Of a matrix that is positive definite by its construction, that is round-off, and others of the
  // step will have it too.
  if (is_definite_) may_factor_ = false;
  return is_definite_;
}

bool HessianSolver::solve(double tolerance, Eigen::Matrix3Xd& v, bool continues) {
  if (coarse_state_ == kNone) factor_coarse();
  parallel_copy(v, residual_);
  parallel_zero(v.cols(), v);
  balance(v);
  if (continues) {
    largest_ = largest_.cwiseMax(squared_);
  } else {
    largest_.setZero();
  }
  squared_.setZero();
  added_.setZero();
  double now = precondition();
  if (now < 0.0 && !is_definite_) return false;
  double last = 0.0;  // 0: directions begin anew
  int wait = kPatience;
  bool is_priced = false;
  const auto may_factor = [this] { return may_factor_ && can_factor() && pairs_state_ != kFresh; };
  for (iterations_ = 0; iterations_ < kMostIterations && now > 0.0; ++iterations_) {
    const double share = last > 0.0 ? now / last : 0.0;
    if (share == 0.0) parallel_zero(v.cols(), direction_);
    for_each_column(
        v, [&](int i) { direction_.col(i) = preconditioned_.col(i) + share * direction_.col(i); });
    matrix_.multiply(direction_, product_);
    rows_.add_product(direction_, product_);
    const double curvature = dot(direction_, product_);
    if (!(curvature > 0.0)) {
      // Of a matrix that is positive definite by its construction, that is round-off.
      if (is_definite_ && std::isfinite(curvature)) break;
      return false;
    }
    const double step = now / curvature;
    for_each_column(v, [&](int i) {
      v.col(i) += step * direction_.col(i);
      residual_.col(i) -= step * product_.col(i);
    });
    add_progress(step, curvature);
    if (iterations_ > 0 && adds_little(tolerance)) break;
    last = now;
    if (may_factor() && iterations_ == wait && !is_priced) {
      wait = std::max(kPatience, price_of_factor());
      is_priced = true;
    }
    if (may_factor() && iterations_ == wait) {
      if (!factor_pairs()) return false;
      last = 0.0;
    } else if (coarse_state_ == kOfOtherRows && iterations_ == kPatience) {
      factor_coarse();
      last = 0.0;
    }
    now = precondition();
    if (now < 0.0 && !is_definite_) return false;
  }
  balance(v);
  return true;
}

}  // namespace pliant
