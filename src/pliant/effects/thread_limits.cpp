#include "pliant/effects/thread_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/parallel.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kGrain = 2048;  // in less, threads cost more than they save
// Of the way to a limit that several sweeps go: limits are convex, so that any share below 2 comes
// nearer to all that fulfils them.
constexpr double kShare = 1.8;
// Of the last word: sweeps, until no thread is too long by more than this share of its length,
// and then iterations for all threads at once.
constexpr int kLastSweeps = 20, kLastIterations = 60;
constexpr double kSweptTolerance = 1e-3;
// Where other couplings moved them. All threads at once would push back what an obstacle pushed
// away, over and over: sweeps leave that to what is near.
constexpr int kSettlingSweeps = 4;

}  // namespace

ThreadLimits::ThreadLimits(const std::vector<std::unique_ptr<ElementSet>>& elements, int particles,
                           double max)
    : max_(max),
      threads_(find_threads(elements, particles)),
      tethers_(find_ways(elements), particles, max) {
  if (threads_.all.empty()) {
    throw InputError(
        "effect 'strain_limit': this cloth has no threads that stretch; give stretch_warp or "
        "stretch_weft");
  }
  pulls_.resize(threads_.all.size(), Eigen::Vector3d::Zero());
}

void ThreadLimits::reset_multipliers() {
  tethers_.reset_multipliers();
  for (Eigen::Vector3d& pull : pulls_) pull.setZero();
}

double ThreadLimits::project(std::size_t t, double share, const Eigen::VectorXd& mobility,
                             Positions& x) {
  const Thread& thread = threads_.all[t];
  const Eigen::Vector3d along = thread.along(x);
  const double squared = along.squaredNorm(), limit = max_ * thread.length;
  if (squared <= limit * limit) return 0.0;
  double own = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    own += thread.weights[k] * thread.weights[k] * mobility[thread.particles[k]];
  }
  const double length = std::sqrt(squared);
  if (own == 0.0) return 0.0;
  const Eigen::Vector3d force = (share * (length - limit) / (own * length)) * along;
  pulls_[t] += force;
  for (std::size_t k = 0; k < 3; ++k) {
    const int i = thread.particles[k];
    x.col(i) -= (mobility[i] * thread.weights[k]) * force;
  }
  return (length - limit) / thread.length;
}

double ThreadLimits::sweep(double share, const Eigen::VectorXd& mobility, Positions& x) {
  tethers_.relax(mobility, x);
  double largest = 0.0;
  for (std::size_t c = 0; c + 1 < threads_.begins.size(); ++c) {
    const int first = threads_.begins[c], last = threads_.begins[c + 1];
    const int blocks = (last - first + kGrain - 1) / kGrain;
    block_largest_.assign(static_cast<std::size_t>(blocks), 0.0);
    parallel_for(0, blocks, 1, [&](int begin, int end) {
      for (int b = begin; b < end; ++b) {
        double& own = block_largest_[static_cast<std::size_t>(b)];
        const int stop = std::min(last, first + (b + 1) * kGrain);
        for (int t = first + b * kGrain; t < stop; ++t) {
          own = std::max(own, project(static_cast<std::size_t>(t), share, mobility, x));
        }
      }
    });
    for (const double own : block_largest_) largest = std::max(largest, own);
  }
  return largest;
}

void ThreadLimits::relax(const Eigen::VectorXd& mobility, Positions& x) { sweep(1.0, mobility, x); }

void ThreadLimits::hold(const Eigen::VectorXd& mobility, double tolerance,
                        const std::vector<KeepsConditions*>& keepers, Positions& x) {
  double largest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kLastSweeps && largest > kSweptTolerance; ++k) {
    largest = sweep(k == 0 ? 1.0 : kShare, mobility, x);
  }
  const bool are_kept = std::all_of(keepers.begin(), keepers.end(), [&](KeepsConditions* keeper) {
    return keeper->missed_conditions(x) <= 1.0;
  });
  if (!are_kept || largest_strain(x) > max_ - 1.0 + tolerance) {
    projection_.project(threads_, max_, mobility, kLastIterations, tolerance, keepers, x);
  }
}

double ThreadLimits::settle(const Eigen::VectorXd& mobility, double tolerance, Positions& x) {
  const double missed = largest_strain(x) - (max_ - 1.0);
  if (missed > tolerance) {
    for (int k = 0; k < kSettlingSweeps; ++k) sweep(k == 0 ? 1.0 : kShare, mobility, x);
  }
  return missed;
}

void ThreadLimits::add_forces(Forces& f) const {
  tethers_.add_forces(f);
  for (std::size_t t = 0; t < threads_.all.size(); ++t) {
    if (pulls_[t].isZero(0.0)) continue;
    const Thread& thread = threads_.all[t];
    for (std::size_t k = 0; k < 3; ++k) {
      f.col(thread.particles[k]) -= thread.weights[k] * pulls_[t];
    }
  }
}

void ThreadLimits::add_rows(const Positions& x, CouplingRows& rows) const {
  for (std::size_t t = 0; t < threads_.all.size(); ++t) {
    if (pulls_[t].isZero(0.0)) continue;
    const Thread& thread = threads_.all[t];
    const Eigen::Vector3d along = thread.along(x);
    const double length = along.norm();
    if (!(length > 0.0)) continue;
    rows.begin_row(max_ * thread.length - length, 0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      if (thread.weights[k] == 0.0) continue;
      rows.add(thread.particles[k], thread.weights[k] / length * along);
    }
  }
}

int ThreadLimits::active() const {
  return static_cast<int>(std::count_if(
      pulls_.begin(), pulls_.end(), [](const Eigen::Vector3d& pull) { return !pull.isZero(0.0); }));
}

double ThreadLimits::largest_strain(const Positions& x) const {
  double largest = -1.0;
  for (const Thread& thread : threads_.all) {
    largest = std::max(largest, thread.along(x).norm() / thread.length - 1.0);
  }
  return largest;
}

}  // namespace pliant
