#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/core/parallel.h"
#include "pliant/solvers/contact_response.h"
#include "pliant/solvers/impulse_balance.h"

/// What contacts and the rigid motions of components do to each other.
namespace pliant {
namespace {

// Over the components of an island that are too many to be solved at once.
constexpr int kSweeps = 10;
constexpr int kComponentGrain = 256;
constexpr int kMaxNewton = 12, kMaxConvexNewton = 40;
// Solutions with given disks of friction.
constexpr int kDisks = 4;
constexpr double kArmijo = 1e-4;
// Differences of the potential below this share of it are round-off.
constexpr double kRoundOff = 1e-14;
// Of the forces that are there: what is left of them is none. Before the first correction less will
// do, since the corrections change more, and the motions hold the impulses of the forces in any case.
constexpr double kLastTolerance = 1e-12, kTolerance = 1e-6;
constexpr double kSmallestStep = 1e-3, kSmallestConvexStep = 1e-9;

}  // namespace

void ImpulseBalance::find_touches(const ProjectiveSystem& system, const Eigen::VectorXd& mobility) {
  const auto& rows = rows_.all();
  touches_.resize(rows.size());
  if (rows.empty()) return;
  // Contacts that share a particle share its mobility, so that together they do not move it too far
  // (mass splitting; Tonge et al. 2012).
  shares_.resize(components_.of.size(), 0);
  for (const ContactRow& row : rows) {
    for (std::size_t k = 0; k < row.count; ++k)
      ++shares_[static_cast<std::size_t>(row.particles[k])];
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const ContactRow& row = rows[r];
    Touch& touch = touches_[r];
    touch = Touch();
    touch.force = row.force();
    double compliance = 0.0;
    for (std::size_t k = 0; k < row.count; ++k) {
      const int i = row.particles[k];
      const double weight = row.weights[k];
      compliance += weight * weight * shares_[static_cast<std::size_t>(i)] * mobility[i];
      const int c = components_.of[static_cast<std::size_t>(i)];
      if (!takes_part(c)) continue;
      Side& side =
          touch.sides[touch.sides[0].component == c || touch.sides[0].component == Components::kNone
                          ? 0
                          : 1];
      const Mode& mode = modes_[static_cast<std::size_t>(c)];
      side.component = c;
      side.weight += weight;
      side.lever += weight / mode.radius * (system.particles.x.col(i) - mode.center);
    }
    const bool moves = touch.sides[0].component != Components::kNone;
    touch.compliance = moves ? compliance : 0.0;
    for (const Side& side : touch.sides) {
      if (side.component == Components::kNone) continue;
      Mode& mode = modes_[static_cast<std::size_t>(side.component)];
      mode.balance.head<3>() += side.weight * touch.force;
      mode.balance.tail<3>() += side.lever.cross(touch.force);
      mode.size += std::abs(side.weight) * touch.force.norm();
    }
  }
  for (const ContactRow& row : rows) {
    for (std::size_t k = 0; k < row.count; ++k)
      shares_[static_cast<std::size_t>(row.particles[k])] = 0;
  }
}

void ImpulseBalance::find_islands() {
  const auto count = static_cast<std::size_t>(components_.count());
  island_of_.resize(count);
  std::iota(island_of_.begin(), island_of_.end(), 0);
  const auto root = [&](int c) {
    while (island_of_[static_cast<std::size_t>(c)] != c)
      c = island_of_[static_cast<std::size_t>(c)];
    return c;
  };
  touch_begins_.assign(count + 1, 0);
  for (const Touch& touch : touches_) {
    if (touch.compliance == 0.0) continue;
    for (const Side& side : touch.sides) {
      if (side.component == Components::kNone) continue;
      ++touch_begins_[static_cast<std::size_t>(side.component) + 1];
      const int a = root(touch.sides[0].component), b = root(side.component);
      island_of_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  for (std::size_t c = 0; c < count; ++c) island_of_[c] = root(static_cast<int>(c));
  std::partial_sum(touch_begins_.begin(), touch_begins_.end(), touch_begins_.begin());
  touches_of_.resize(static_cast<std::size_t>(touch_begins_.back()));
  next_.assign(touch_begins_.begin(), touch_begins_.end() - 1);
  for (std::size_t r = 0; r < touches_.size(); ++r) {
    if (touches_[r].compliance == 0.0) continue;
    for (const Side& side : touches_[r].sides) {
      if (side.component == Components::kNone) continue;
      int& at = next_[static_cast<std::size_t>(side.component)];
      touches_of_[static_cast<std::size_t>(at++)] = static_cast<int>(r);
    }
  }
  // Components by their island.
  by_island_.resize(count);
  std::iota(by_island_.begin(), by_island_.end(), 0);
  std::stable_sort(by_island_.begin(), by_island_.end(), [&](int a, int b) {
    return island_of_[static_cast<std::size_t>(a)] < island_of_[static_cast<std::size_t>(b)];
  });
}

void ImpulseBalance::solve_islands(bool is_last) {
  tolerance_ = is_last ? kLastTolerance : kTolerance;
  find_islands();
  parallel_for(0, components_.count(), kComponentGrain, [&](int begin, int end) {
    for (int c = begin; c < end; ++c) {
      // What touches something is in balance with its forces so far, more or less.
      if (takes_part(c) && !is_touched(c)) push(modes_[static_cast<std::size_t>(c)], false);
    }
  });
  if (touches_.empty()) return;
  const auto island = [&](std::size_t k) {
    return island_of_[static_cast<std::size_t>(by_island_[k])];
  };
  for (std::size_t begin = 0, end = 0; begin < by_island_.size(); begin = end) {
    for (end = begin; end < by_island_.size() && island(end) == island(begin);) ++end;
    if (!is_touched(by_island_[begin])) continue;
    const int* components = by_island_.data() + begin;
    if (end - begin <= kMostAtOnce) {
      solve(components, end - begin);
      continue;
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (std::size_t k = 0; k < end - begin; ++k) solve(components + k, 1);
    }
  }
  take_forces();
}

Eigen::Vector3d ImpulseBalance::displacement(const Touch& touch) const {
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  for (const Side& side : touch.sides) {
    if (side.component == Components::kNone) continue;
    const Vector6& motion = modes_[static_cast<std::size_t>(side.component)].motion;
    u += side.weight * motion.head<3>() + motion.tail<3>().cross(side.lever);
  }
  return u;
}

double ImpulseBalance::find_residual(const int* components, std::size_t count) {
  residual_.resize(static_cast<Eigen::Index>(6 * count));
  for (std::size_t k = 0; k < count; ++k) {
    const Mode& mode = modes_[static_cast<std::size_t>(components[k])];
    residual_.segment<6>(static_cast<Eigen::Index>(6 * k)) =
        mode.unbalanced - mode.inertia * mode.motion;
  }
  for (const int r : solved_) {
    Touch& touch = touches_[static_cast<std::size_t>(r)];
    const ContactRow& row = rows_.all()[static_cast<std::size_t>(r)];
    const Eigen::Vector3d u = displacement(touch);
    touch.now = is_coulomb_ ? ContactResponse(row, touch.compliance, u)
                            : ContactResponse::with_bound(row, touch.compliance, u, touch.bound);
    const Eigen::Vector3d force = touch.now.force(row);
    for (const Side& side : touch.sides) {
      const int at = side.component == Components::kNone
                         ? -1
                         : place_[static_cast<std::size_t>(side.component)];
      if (at < 0) continue;
      residual_.segment<3>(6 * at) += side.weight * force;
      residual_.segment<3>(6 * at + 3) += side.lever.cross(force);
    }
  }
  return residual_.cwiseAbs().maxCoeff();
}

void ImpulseBalance::assemble(const int* components, std::size_t count, Eigen::MatrixXd& matrix) {
  matrix.setZero();
  for (std::size_t k = 0; k < count; ++k) {
    const auto at = static_cast<Eigen::Index>(6 * k);
    matrix.block<6, 6>(at, at) = modes_[static_cast<std::size_t>(components[k])].inertia;
  }
  using Block = Eigen::Matrix<double, 3, 6>;
  for (const int r : solved_) {
    const Touch& touch = touches_[static_cast<std::size_t>(r)];
    const Eigen::Matrix3d stiffness =
        touch.now.stiffness(rows_.all()[static_cast<std::size_t>(r)], is_coulomb_);
    if (stiffness.isZero(0.0)) continue;
    Block moved[2];  // u of the component's motion
    int at[2];
    for (int s = 0; s < 2; ++s) {
      const Side& side = touch.sides[s];
      at[s] = side.component == Components::kNone
                  ? -1
                  : place_[static_cast<std::size_t>(side.component)];
      moved[s] << side.weight * Eigen::Matrix3d::Identity(), -rigid::cross_matrix(side.lever);
    }
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) {
        if (at[a] < 0 || at[b] < 0) continue;
        matrix.block<6, 6>(6 * at[a], 6 * at[b]) += moved[a].transpose() * stiffness * moved[b];
      }
    }
  }
}

double ImpulseBalance::potential(const int* components, std::size_t count) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const Mode& mode = modes_[static_cast<std::size_t>(components[k])];
    sum += mode.motion.dot(0.5 * mode.inertia * mode.motion - mode.unbalanced);
  }
  for (const int r : solved_) {
    const auto at = static_cast<std::size_t>(r);
    sum += touches_[at].now.potential(rows_.all()[at]);
  }
  return sum;
}

void ImpulseBalance::begin_solving(const int* components, std::size_t count) {
  place_.resize(static_cast<std::size_t>(components_.count()), -1);
  solved_.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const auto c = static_cast<std::size_t>(components[k]);
    place_[c] = static_cast<int>(k);
    for (int t = touch_begins_[c]; t < touch_begins_[c + 1]; ++t) {
      const int r = touches_of_[static_cast<std::size_t>(t)];
      // A contact of two of them comes twice.
      const int first = touches_[static_cast<std::size_t>(r)].sides[0].component;
      if (first == components[k] || place_[static_cast<std::size_t>(first)] < 0) {
        solved_.push_back(r);
      }
    }
  }
}

void ImpulseBalance::solve(const int* components, std::size_t count) {
  begin_solving(components, count);
  start_.resize(static_cast<Eigen::Index>(6 * count));
  for (std::size_t k = 0; k < count; ++k) {
    start_.segment<6>(static_cast<Eigen::Index>(6 * k)) =
        modes_[static_cast<std::size_t>(components[k])].motion;
  }
  is_coulomb_ = true;
  if (!newton(components, count)) {
    // Friction that follows the normal force need not have a solution that is found so. With disks
    // that are given there is always one; they follow from one solution to the next.
    is_coulomb_ = false;
    for (std::size_t k = 0; k < count; ++k) {
      modes_[static_cast<std::size_t>(components[k])].motion =
          start_.segment<6>(static_cast<Eigen::Index>(6 * k));
    }
    for (const int r : solved_) {
      const auto at = static_cast<std::size_t>(r);
      touches_[at].bound = rows_.all()[at].friction_bound(rows_.all()[at].normal_force);
    }
    for (int k = 0; k < kDisks; ++k) {
      newton(components, count);
      if (k + 1 == kDisks) break;
      for (const int r : solved_) {
        const auto at = static_cast<std::size_t>(r);
        touches_[at].bound = rows_.all()[at].friction_bound(touches_[at].now.normal_force);
      }
    }
  }
  for (std::size_t k = 0; k < count; ++k) place_[static_cast<std::size_t>(components[k])] = -1;
}

void ImpulseBalance::advance(const int* components, std::size_t count, double share) {
  for (std::size_t k = 0; k < count; ++k) {
    modes_[static_cast<std::size_t>(components[k])].motion +=
        share * step_.segment<6>(static_cast<Eigen::Index>(6 * k));
  }
}

bool ImpulseBalance::newton(const int* components, std::size_t count) {
  Eigen::MatrixXd& matrix = matrices_[count];
  Eigen::PartialPivLU<Eigen::MatrixXd>& factor = factors_[count];
  const auto unknowns = static_cast<Eigen::Index>(6 * count);
  matrix.resize(unknowns, unknowns);
  step_.resize(unknowns);
  double size = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    size = std::max(size, modes_[static_cast<std::size_t>(components[k])].size);
  }
  const int most = is_coulomb_ ? kMaxNewton : kMaxConvexNewton;
  const double smallest = is_coulomb_ ? kSmallestStep : kSmallestConvexStep;
  double error = find_residual(components, count);
  for (int k = 0; k < most && error > tolerance_ * size; ++k) {
    assemble(components, count, matrix);
    factor.compute(matrix);
    step_ = factor.solve(residual_);
    const double slope = residual_.dot(step_);
    const double before = is_coulomb_ ? 0.0 : potential(components, count);
    const double slack = kRoundOff * std::abs(before);
    double share = 1.0, last = 0.0, now = error;
    for (;; share *= 0.5) {
      advance(components, count, share - last);
      last = share;
      now = find_residual(components, count);
      if (share < smallest) break;
      const bool is_lower =
          is_coulomb_ ? now < error
                      : potential(components, count) <= before - kArmijo * share * slope + slack;
      if (is_lower) break;
    }
    if (share < smallest) return false;
    error = now;
  }
  return error <= tolerance_ * size;
}

void ImpulseBalance::push(Mode& mode, bool from_here) const {
  if (from_here) {
    mode.motion += mode.inertia.partialPivLu().solve(mode.balance - mode.inertia * mode.motion);
  } else {
    mode.motion = has_outer_ ? Vector6(mode.inertia.partialPivLu().solve(mode.unbalanced))
                             : mode.holding(mode.unbalanced);
  }
}

void ImpulseBalance::take_forces() {
  for (Mode& mode : modes_) mode.balance = mode.unbalanced;
  for (std::size_t r = 0; r < touches_.size(); ++r) {
    Touch& touch = touches_[r];
    if (touch.compliance == 0.0) continue;
    ContactRow& row = rows_.all()[r];
    row.normal_force = touch.now.normal_force;
    row.friction_force = touch.now.friction_force;
    const Eigen::Vector3d force = row.force();
    for (const Side& side : touch.sides) {
      if (side.component == Components::kNone) continue;
      Mode& mode = modes_[static_cast<std::size_t>(side.component)];
      mode.balance.head<3>() += side.weight * force;
      mode.balance.tail<3>() += side.lever.cross(force);
    }
  }
  // Whatever the search left, the impulses of these forces are what the motions hold.
  for (int c = 0; c < components_.count(); ++c) {
    if (takes_part(c) && is_touched(c)) push(modes_[static_cast<std::size_t>(c)], true);
  }
}

}  // namespace pliant
