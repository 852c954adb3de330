#include "pliant/solvers/iterations/step_objective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/columns.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/core/step/step_report.h"

namespace pliant {
namespace {

constexpr int kGrain = 1024, kSumGrain = 4096;
// Forces that moving all particles by so much of their distance from the origin makes are
// round-off.
constexpr double kRoundOff = 32.0 * std::numeric_limits<double>::epsilon();

// Of all forces, and of their share by a piece's mass, squared: what a piece that hardly anything
// pushes is compared with.
constexpr double kLeastShare = 1e-4;

class Diagonal final : public SystemMatrix {
 public:
  explicit Diagonal(Eigen::VectorXd& values) : values_(values) {}
  void add(int row, int column, double stiffness) override {
    if (row == column) values_[row] += stiffness;
  }
  void add_shared(const SharedEntries& shared) override {
    for (const SharedEntries::Member& member : shared.members) {
      const double share = 1.0 - member.mass / shared.mass;
      values_[member.particle] += shared.stiffness * member.mass * share;
    }
  }

 private:
  Eigen::VectorXd& values_;
};

void zero_fixed(const Particles& particles, Forces& f) {
  for_each_column(f, [&](int i) {
    if (particles.is_fixed(i)) f.col(i).setZero();
  });
}

}  // namespace

void StepObjective::prepare(const ProjectiveSystem& system, double dt) {
  inertia_ = system.particles.mass / (dt * dt);
  diagonal_ = inertia_;
  Diagonal diagonal(diagonal_);
  for (const auto& set : system.elements) set->add_to_system(diagonal);
  pieces_ = Pieces(find_components(system), system.particles.mass);
  if (pieces_.are_one()) {
    diagonals_.setConstant(pieces_.count(), diagonal_.sum());
  } else {
    pieces_.sum([this](int i) { return diagonal_[i]; }, diagonals_);
  }
  stiffness_ratio_ = 1.0;
  for (int i = 0; i < system.particles.size(); ++i) {
    if (system.particles.is_fixed(i)) continue;
    stiffness_ratio_ = std::max(stiffness_ratio_, diagonal_[i] / inertia_[i]);
  }
}

void StepObjective::begin_step(const Positions& predicted) {
  parallel_copy(predicted, predicted_);
  scales_.setZero(pieces_.count());
  reach_ = largest_coordinate(predicted_);
  round_off_ = kRoundOff * std::sqrt(diagonal_.sum()) * reach_;
}

double StepObjective::value(const ProjectiveSystem& system) const {
  const Particles& particles = system.particles;
  const double kinetic = parallel_sum(0, particles.size(), kSumGrain, [&](int i) {
    if (particles.is_fixed(i)) return 0.0;
    return 0.5 * inertia_[i] * (particles.x.col(i) - predicted_.col(i)).squaredNorm();
  });
  return kinetic + system.elastic_energy() + system.viscous_energy();
}

void StepObjective::forces(const ProjectiveSystem& system, Forces& r, StepReport& report) const {
  const Particles& particles = system.particles;
  r.resize(3, particles.size());
  parallel_for(0, particles.size(), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      r.col(i) = inertia_[i] * (predicted_.col(i) - particles.x.col(i));
    }
  });
  for (const auto& set : system.elements) {
    ScopedPhase phase(report, set->name());
    set->add_forces(particles.x, r);
  }
  zero_fixed(particles, r);
}

double StepObjective::norm(const Forces& f) const {
  return std::sqrt(parallel_sum(0, static_cast<int>(f.cols()), kSumGrain,
                                [&](int i) { return f.col(i).squaredNorm() / diagonal_[i]; }));
}

void StepObjective::square(const Forces& f, const Eigen::VectorXd& missed,
                           Eigen::VectorXd& squares) const {
  const auto square_of = [&](int i) {
    return f.col(i).squaredNorm() / diagonal_[i] + (missed.size() > 0 ? missed[i] : 0.0);
  };
  if (pieces_.are_one()) {
    squares.setConstant(pieces_.count(),
                        parallel_sum(0, static_cast<int>(f.cols()), kSumGrain, square_of));
  } else {
    pieces_.sum(square_of, squares);
  }
}

void StepObjective::take_scales(const Forces& f) {
  square(f, {}, residuals_);
  scales_ = scales_.cwiseMax(residuals_);
}

double StepObjective::largest_share() const {
  const double whole = pieces_.are_one() ? scales_[0] : scales_.sum();
  double largest = 0.0;
  for (int k = 0; k < pieces_.count(); ++k) {
    const double round_off = kRoundOff * kRoundOff * diagonals_[k] * reach_ * reach_;
    if (pieces_.mass_share(k) == 0.0 || residuals_[k] <= round_off) continue;
    const double least = kLeastShare * pieces_.mass_share(k) * whole;
    largest = std::max(largest, residuals_[k] / std::max({scales_[k], least, round_off}));
  }
  return std::sqrt(largest);
}

double StepObjective::relative_residual(const ProjectiveSystem& system, const Forces& r,
                                        int iteration, const Eigen::VectorXd& violations) {
  if (iteration <= 2) take_scales(r);
  if (system.constraints.empty()) {
    square(r, violations, residuals_);
  } else {
    parallel_zero(r.cols(), balance_);
    for (const Constraint* constraint : system.constraints) constraint->add_forces(balance_);
    zero_fixed(system.particles, balance_);
    // In a body at rest on a table the first residual is tiny beside what contact soon balances.
    if (iteration <= 2) take_scales(balance_);
    for_each_column(balance_, [&](int i) { balance_.col(i) += r.col(i); });
    square(balance_, violations, residuals_);
  }
  last_residual_ = std::sqrt(pieces_.are_one() ? residuals_[0] : residuals_.sum());
  return largest_share();
}

}  // namespace pliant
