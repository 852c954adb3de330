#include "pliant/effects/strain_limit/yarn_projection.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel_reduce.h"

namespace pliant {
namespace {

constexpr int kGrain = 2048;  // in less, threads cost more than they save
// κ over the inertia of a particle and their number. The larger, the fewer iterations to lengths
// that hold, and the more of the cloth a correction moves that need not move.
constexpr double kStiffness = 3.0;
// Over-relaxation (Boyd et al. 2011, sec. 3.4.3).
constexpr double kOver = 1.7;
// Iterations after which conditions are taken anew where they are: they are linear in what moves.
constexpr int kAskAgain = 30;
// Of its inertia, which may change before there is a new factor: the method is as exact, since
// forces move particles by the mobility that they have.
constexpr double kSameInertia = 2e-3;

Eigen::Vector3d within(const Eigen::Vector3d& v, double limit) {
  const double squared = v.squaredNorm();
  return squared <= limit * limit ? v : Eigen::Vector3d(limit / std::sqrt(squared) * v);
}

/// Calls use(yarn's number, slot, particle, weight) colour by colour for particles that move.
template <class Use>
void for_each_end(const Yarns& yarns, const Eigen::VectorXd& inertia, const Use& use) {
  for (std::size_t c = 0; c + 1 < yarns.begins.size(); ++c) {
    parallel_for(yarns.begins[c], yarns.begins[c + 1], kGrain, [&](int begin, int end) {
      for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
        const Yarn& yarn = yarns.all[t];
        for (std::size_t k = 0; k < 3; ++k) {
          const int i = yarn.particles[k];
          if (yarn.weights[k] != 0.0 && inertia[i] != 0.0) use(t, i, yarn.weights[k]);
        }
      }
    });
  }
}

SparseRows matrix_of(const Yarns& yarns, const Eigen::VectorXd& inertia, double stiffness) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < inertia.size(); ++i) {
    entries.emplace_back(i, i, inertia[i] == 0.0 ? 1.0 : inertia[i]);
  }
  for (const Yarn& yarn : yarns.all) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t l = 0; l < 3; ++l) {
        const int i = yarn.particles[k], j = yarn.particles[l];
        const double both = yarn.weights[k] * yarn.weights[l];
        if (both == 0.0 || inertia[i] == 0.0 || inertia[j] == 0.0) continue;
        entries.emplace_back(i, j, stiffness * both);
      }
    }
  }
  SparseRows a(inertia.size(), inertia.size());
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

}  // namespace

void YarnProjection::prepare(const Yarns& yarns, const Eigen::VectorXd& mobility) {
  const auto moving = static_cast<double>((mobility.array() > 0.0).count());
  scale_ = moving / mobility.sum();
  const auto inertia = [&](Eigen::Index i) {
    return mobility[i] > 0.0 ? 1.0 / (scale_ * mobility[i]) : 0.0;
  };
  bool is_same = inertia_.size() == mobility.size();
  for (Eigen::Index i = 0; is_same && i < mobility.size(); ++i) {
    is_same = std::abs(inertia(i) - inertia_[i]) <= kSameInertia * inertia_[i];
  }
  if (is_same) return;
  inertia_.resize(mobility.size());
  for (Eigen::Index i = 0; i < mobility.size(); ++i) inertia_[i] = inertia(i);
  stiffness_ = kStiffness * moving;
  factor_.factor(matrix_of(yarns, inertia_, stiffness_));
  states_.resize(yarns.all.size());
}

void YarnProjection::begin(const Yarns& yarns, double max, const Positions& x) {
  parallel_for(0, static_cast<int>(states_.size()), kGrain, [&](int begin, int end) {
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      State& state = states_[t];
      state.start = state.v = yarns.all[t].along(x);
      state.z = within(state.v, max * yarns.all[t].length);
    }
  });
}

void YarnProjection::solve(const Yarns& yarns) {
  // (1/mobility + κ AᵀA) d = κ Aᵀ(z − u − a), u = v − z
  moved_.setZero(3, inertia_.size());
  for_each_end(yarns, inertia_, [&](std::size_t t, int i, double weight) {
    const State& state = states_[t];
    moved_.col(i) += (stiffness_ * weight) * (2.0 * state.z - state.v - state.start);
  });
  factor_.solve(moved_);
  conditions_.apply(moved_);
}

bool YarnProjection::keeps(const std::vector<LinearConstraintProvider*>& keepers,
                           const Positions& y) {
  if (keepers.empty()) return true;
  at_ = y + moved_;
  tell_changes();
  return std::all_of(keepers.begin(), keepers.end(), [&](LinearConstraintProvider* keeper) {
    return keeper->missed_linear_constraints(at_) <= 1.0;
  });
}

void YarnProjection::ask(const std::vector<LinearConstraintProvider*>& keepers,
                         const Positions& y) {
  std::swap(asked_, asked_before_);
  asked_.clear();
  if (!keepers.empty()) at_ = y + moved_;
  for (LinearConstraintProvider* keeper : keepers) keeper->add_linear_constraints(at_, asked_);
  // What is asked for no more holds nothing.
  for (std::size_t k = 0; k < asked_before_.size(); ++k) {
    asked_before_[k].owner->set_change(asked_before_[k].number, 0.0);
  }
  conditions_.take(asked_, inertia_, scale_, moved_, factor_);
}

void YarnProjection::tell_changes() const {
  for (std::size_t k = 0; k < asked_.size(); ++k) {
    asked_[k].owner->set_change(asked_[k].number, conditions_.change(k));
  }
}

double YarnProjection::clip(const Yarns& yarns, double max) {
  const auto of_part = [&](int begin, int end) {
    double largest = 0.0;
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      State& state = states_[t];
      const double length = yarns.all[t].length, limit = max * length;
      const Eigen::Vector3d a = state.start + yarns.all[t].along(moved_);
      largest = std::max(largest, (a.norm() - limit) / length);
      const Eigen::Vector3d u = state.v - state.z;
      state.pull = u + a - state.z;
      state.v = u + kOver * a + (1.0 - kOver) * state.z;
      state.z = within(state.v, limit);
    }
    return largest;
  };
  return parallel_reduce(0, static_cast<int>(states_.size()), kGrain, of_part,
                         [](double a, double b) { return std::max(a, b); });
}

void YarnProjection::add_pulls(const Yarns& yarns, const Eigen::VectorXd& mobility,
                               Positions& x) const {
  // With the forces themselves, not with d: they are in pairs to round-off.
  const double stiffness = stiffness_ * scale_;
  for_each_end(yarns, mobility, [&](std::size_t t, int i, double weight) {
    x.col(i) -= (stiffness * weight * mobility[i]) * states_[t].pull;
  });
}

int YarnProjection::project(const Yarns& yarns, double max, const Eigen::VectorXd& mobility,
                            int iterations, double tolerance,
                            const std::vector<LinearConstraintProvider*>& keepers, Positions& x) {
  if (!(mobility.maxCoeff() > 0.0)) return 0;
  prepare(yarns, mobility);
  begin(yarns, max, x);
  moved_.setZero(3, inertia_.size());
  asked_.clear();
  ask(keepers, x);
  int taken = 0, asked_at = 0;
  while (taken < iterations) {
    solve(yarns);
    ++taken;
    const bool fits = clip(yarns, max) <= tolerance;
    if (!fits && taken < asked_at + kAskAgain) continue;
    if (keeps(keepers, x)) {
      if (fits) break;
    } else if (taken < iterations) {
      ask(keepers, x);
    }
    asked_at = taken;
  }
  if (taken == 0) return 0;
  add_pulls(yarns, mobility, x);
  conditions_.add_forces(mobility, x);
  tell_changes();
  for (LinearConstraintProvider* keeper : keepers) keeper->take_changes();
  return taken;
}

}  // namespace pliant
