#include "pliant/effects/strain_limit/yarn_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kGrain = 2048;  // in less, threads cost more than they save
// Of the distance to a limit that several sweeps go: limits are convex, so that any share below 2
// comes nearer to all that fulfils them.
constexpr double kShare = 1.8;
// Of the final projection: sweeps, until no yarn is too long by more than this share of its length,
// and then iterations for all yarns at once.
constexpr int kLastSweeps = 20, kLastIterations = 60;
constexpr double kSweptTolerance = 1e-3;
// Where other constraints moved them. All yarns at once would push back what an obstacle pushed
// away, over and over: sweeps leave that to what is near.
constexpr int kSettlingSweeps = 4;

}  // namespace

YarnLimits::YarnLimits(const std::vector<std::unique_ptr<ElementSet>>& elements, int particles,
                       double max)
    : max_(max),
      yarns_(find_yarns(elements, particles)),
      tethers_(find_edges(elements), particles, max) {
  if (yarns_.all.empty()) {
    throw InputError(
        "effect 'strain_limit': this cloth has no yarns that stretch; give stretch_warp or "
        "stretch_weft");
  }
  pulls_.resize(yarns_.all.size(), Eigen::Vector3d::Zero());
}

void YarnLimits::reset_multipliers() {
  tethers_.reset_multipliers();
  for (Eigen::Vector3d& pull : pulls_) pull.setZero();
}

double YarnLimits::project(std::size_t t, double share, const Eigen::VectorXd& mobility,
                           Positions& x) {
  const Yarn& yarn = yarns_.all[t];
  const Eigen::Vector3d along = yarn.along(x);
  const double squared = along.squaredNorm(), limit = max_ * yarn.length;
  if (squared <= limit * limit) return 0.0;
  double own = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    own += yarn.weights[k] * yarn.weights[k] * mobility[yarn.particles[k]];
  }
  const double length = std::sqrt(squared);
  if (own == 0.0) return 0.0;
  const Eigen::Vector3d force = (share * (length - limit) / (own * length)) * along;
  pulls_[t] += force;
  for (std::size_t k = 0; k < 3; ++k) {
    const int i = yarn.particles[k];
    x.col(i) -= (mobility[i] * yarn.weights[k]) * force;
  }
  return (length - limit) / yarn.length;
}

double YarnLimits::sweep(double share, const Eigen::VectorXd& mobility, Positions& x) {
  tethers_.relax(mobility, x);
  double largest = 0.0;
  for (std::size_t c = 0; c + 1 < yarns_.begins.size(); ++c) {
    const int first = yarns_.begins[c], last = yarns_.begins[c + 1];
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

void YarnLimits::relax(const Eigen::VectorXd& mobility, Positions& x) { sweep(1.0, mobility, x); }

void YarnLimits::hold(const Eigen::VectorXd& mobility, double tolerance,
                      const std::vector<LinearConstraintProvider*>& keepers, Positions& x) {
  double largest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kLastSweeps && largest > kSweptTolerance; ++k) {
    largest = sweep(k == 0 ? 1.0 : kShare, mobility, x);
  }
  const bool are_kept =
      std::all_of(keepers.begin(), keepers.end(), [&](LinearConstraintProvider* keeper) {
        return keeper->missed_linear_constraints(x) <= 1.0;
      });
  if (!are_kept || largest_strain(x) > max_ - 1.0 + tolerance) {
    projection_.project(yarns_, max_, mobility, kLastIterations, tolerance, keepers, x);
  }
}

double YarnLimits::alternating_projection(const Eigen::VectorXd& mobility, double tolerance,
                                          Positions& x) {
  const double missed = largest_strain(x) - (max_ - 1.0);
  if (missed > tolerance) {
    for (int k = 0; k < kSettlingSweeps; ++k) sweep(k == 0 ? 1.0 : kShare, mobility, x);
  }
  return missed;
}

void YarnLimits::add_forces(Forces& f) const {
  tethers_.add_forces(f);
  for (std::size_t t = 0; t < yarns_.all.size(); ++t) {
    if (pulls_[t].isZero(0.0)) continue;
    const Yarn& yarn = yarns_.all[t];
    for (std::size_t k = 0; k < 3; ++k) {
      f.col(yarn.particles[k]) -= yarn.weights[k] * pulls_[t];
    }
  }
}

void YarnLimits::add_rows(const Positions& x, ConstraintRows& rows) const {
  for (std::size_t t = 0; t < yarns_.all.size(); ++t) {
    if (pulls_[t].isZero(0.0)) continue;
    const Yarn& yarn = yarns_.all[t];
    const Eigen::Vector3d along = yarn.along(x);
    const double length = along.norm();
    if (!(length > 0.0)) continue;
    rows.begin_row(max_ * yarn.length - length, 0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      if (yarn.weights[k] == 0.0) continue;
      rows.add(yarn.particles[k], yarn.weights[k] / length * along);
    }
  }
}

int YarnLimits::active() const {
  return static_cast<int>(std::count_if(
      pulls_.begin(), pulls_.end(), [](const Eigen::Vector3d& pull) { return !pull.isZero(0.0); }));
}

double YarnLimits::largest_strain(const Positions& x) const {
  double largest = -1.0;
  for (const Yarn& yarn : yarns_.all) {
    largest = std::max(largest, yarn.along(x).norm() / yarn.length - 1.0);
  }
  return largest;
}

}  // namespace pliant
