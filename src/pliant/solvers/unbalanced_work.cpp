#include "pliant/solvers/unbalanced_work.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/columns.h"
#include "pliant/core/step_report.h"
#include "pliant/elements/attachment_set.h"

namespace pliant {
namespace {

// Of |d|² M/h², the least curvature along d: with so little work that alone says far enough where
// it ends.
constexpr double kLittle = 1e-6;
// Share of the work that may be left where the curvature changes along the way.
constexpr double kLeftOver = 0.05;
constexpr int kMaxLooks = 3;
// Share of its way that a body may lose before its user has to know.
constexpr double kTold = 0.1;

/// Whether nothing outside the body acts on it but given forces.
bool is_free(const ProjectiveSystem& system) {
  const Particles& particles = system.particles;
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) return false;
  }
  for (const auto& set : system.elements) {
    const auto* attachments = dynamic_cast<const AttachmentSet*>(set.get());
    if (attachments != nullptr && attachments->size() > 0) return false;
  }
  return std::all_of(system.couplings.begin(), system.couplings.end(),
                     [](const Coupling* coupling) { return coupling->active() == 0; });
}

double dot(const Forces& f, const Positions& d) {
  return parallel_sum(0, static_cast<int>(f.cols()), kColumnGrain,
                      [&](int i) { return f.col(i).dot(d.col(i)); });
}

}  // namespace

void UnbalancedWork::take_way(const ProjectiveSystem& system) {
  const Particles& particles = system.particles;
  if (way_.cols() != particles.size()) {
    // All at once: later steps allocate nothing.
    end_.resize(3, particles.size());
    way_.resize(3, particles.size());
    balance_.resize(3, particles.size());
    rigid_part_.prepare(particles.x_start, particles.mass);
  }
  for_each_column(way_, [&](int i) {
    if (particles.is_fixed(i)) {
      way_.col(i).setZero();
    } else {
      way_.col(i) = particles.x.col(i) - particles.x_start.col(i);
    }
  });
}

void UnbalancedWork::take_balance(const ProjectiveSystem& system, const Forces& forces) {
  parallel_copy(forces, balance_);
  for (const Coupling* coupling : system.couplings) coupling->add_forces(balance_);
}

void UnbalancedWork::hold(ProjectiveSystem& system, const StepObjective& objective, Forces& forces,
                          StepReport& report) {
  take_way(system);
  take_balance(system, forces);
  if (is_free(system)) {
    rigid_part_.prepare(system.particles.x_start, system.particles.mass);
    rigid_part_.remove(way_);
  }
  const double work = -dot(balance_, way_);
  const double inertia = parallel_sum(0, system.particles.size(), kColumnGrain, [&](int i) {
    return objective.inertia()[i] * way_.col(i).squaredNorm();
  });
  if (!(work > 0.0) || inertia == 0.0) return;
  Positions& x = system.particles.x;
  parallel_copy(x, end_);
  double part = 1.0 - work / inertia;
  if (work > kLittle * inertia) {
    part = share(system, objective, work, work + dot(forces, way_), forces, report);
  }
  go(x, part);
  if (part > 1.0 - kTold) return;
  report.add_figure("energy_held", 1.0 - part);
  report.warn(
      "energy_held: the iterations left forces that would have made energy from nowhere, and the "
      "body moves less than it should; take more iterations or a smaller time step");
}

double UnbalancedWork::share(ProjectiveSystem& system, const StepObjective& objective, double work,
                             double held, Forces& forces, StepReport& report) {
  // W(s) of the part s of the way, by false position.
  const auto work_at = [&](double part) {
    go(system.particles.x, part);
    objective.forces(system, forces, report);
    return held - dot(forces, way_);
  };
  double low = 0.0, high = 1.0, above = work, below = work_at(low);
  // Even where it began: something else pushes it that way.
  if (!(below < 0.0)) return 1.0;
  double part = 1.0;
  for (int look = 0; look < kMaxLooks; ++look) {
    part = low - below * (high - low) / (above - below);
    if (look + 1 == kMaxLooks || 1.0 - part < kTold) break;
    const double there = work_at(part);
    if (std::abs(there) <= kLeftOver * work) break;
    (there > 0.0 ? high : low) = part;
    (there > 0.0 ? above : below) = there;
  }
  return part;
}

void UnbalancedWork::go(Positions& x, double share) const {
  for_each_column(x, [&](int i) { x.col(i) = end_.col(i) - (1.0 - share) * way_.col(i); });
}

}  // namespace pliant
