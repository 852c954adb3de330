#include "pliant/solvers/step_objective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/parallel.h"
#include "pliant/core/step_report.h"

namespace pliant {
namespace {

constexpr int kGrain = 4096;
// Forces that moving all particles by so much of their distance from the origin makes are
// round-off.
constexpr double kRoundOff = 32.0 * std::numeric_limits<double>::epsilon();

class Diagonal final : public SystemMatrix {
 public:
  explicit Diagonal(Eigen::VectorXd& values) : values_(values) {}
  void add(int row, int column, double stiffness) override {
    if (row == column) values_[row] += stiffness;
  }

 private:
  Eigen::VectorXd& values_;
};

}  // namespace

void StepObjective::prepare(const ProjectiveSystem& system, double dt) {
  inertia_ = system.particles.mass / (dt * dt);
  diagonal_ = inertia_;
  Diagonal diagonal(diagonal_);
  for (const auto& set : system.elements) set->add_to_system(diagonal);
  stiffness_ratio_ = 1.0;
  for (int i = 0; i < system.particles.size(); ++i) {
    if (system.particles.is_fixed(i)) continue;
    stiffness_ratio_ = std::max(stiffness_ratio_, diagonal_[i] / inertia_[i]);
  }
}

void StepObjective::begin_step(const ProjectiveSystem& system) {
  predicted_ = system.particles.x;
  scale_ = 0.0;
  const double reach = predicted_.size() > 0 ? predicted_.cwiseAbs().maxCoeff() : 0.0;
  round_off_ = kRoundOff * std::sqrt(diagonal_.sum()) * reach;
}

double StepObjective::value(const ProjectiveSystem& system) const {
  const Particles& particles = system.particles;
  double sum = 0.0;
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) continue;
    sum += 0.5 * inertia_[i] * (particles.x.col(i) - predicted_.col(i)).squaredNorm();
  }
  return sum + system.elastic_energy();
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
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) r.col(i).setZero();
  }
}

double StepObjective::norm(const Forces& f) const {
  double sum = 0.0;
  for (int i = 0; i < f.cols(); ++i) sum += f.col(i).squaredNorm() / diagonal_[i];
  return std::sqrt(sum);
}

double StepObjective::relative_residual(const ProjectiveSystem& system, const Forces& r,
                                        int iteration) {
  double residual = norm(r);
  if (iteration <= 2) scale_ = std::max(scale_, residual);
  if (!system.couplings.empty()) {
    const Particles& particles = system.particles;
    balance_.setZero(3, r.cols());
    for (const Coupling* coupling : system.couplings) coupling->add_forces(balance_);
    for (int i = 0; i < particles.size(); ++i) {
      if (particles.is_fixed(i)) balance_.col(i).setZero();
    }
    // In a body at rest on a table the first residual is tiny beside what contact soon balances.
    if (iteration <= 2) scale_ = std::max(scale_, norm(balance_));
    balance_ += r;
    residual = norm(balance_);
  }
  return is_round_off(residual) ? 0.0 : residual / std::max(scale_, round_off_);
}

}  // namespace pliant
