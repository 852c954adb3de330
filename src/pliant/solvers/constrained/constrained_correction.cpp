#include "pliant/solvers/constrained/constrained_correction.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Likewise where constraints contradict each other: their forces grow with each correction.
constexpr double kContradicted = 1.0;
// Of C between rigid bodies. Their contacts are the corners of what touches: where hundreds would
// share a force, and each give way by its part of it, four do.
constexpr double kRigid = 0.125;
// The next correction goes on where this one stopped.
constexpr int kMaxRounds = 12;
constexpr int kMaxTrials = 8;
// Cautious rounds that take the bound of friction as the normal force tells it. Later ones take the
// mean of that and of the last one: without it, a point that opens and closes by its own friction
// goes on for ever.
constexpr int kPlainRounds = 3;
constexpr int kMaxIterations = 100;
// What is left out of balance, as a share of all forces, that is none.
constexpr double kSettled = 1e-9;
// Of the equations' residual at the start: of the first round, and of each.
constexpr double kTolerance = 1e-8, kRoundTolerance = 1e-4;
// Of the bound of friction, that is no more than what rounds leave.
constexpr double kBoundRoundOff = 1e-6;
// Of the slope along a round's displacement, that is flat enough.
constexpr double kFlat = 0.1;

void zero_pinned(const Eigen::VectorXd& mobility, Forces& f) {
  for (Eigen::Index i = 0; i < mobility.size(); ++i) {
    if (mobility[i] == 0.0) f.col(i).setZero();
  }
}

}  // namespace

bool ConstrainedCorrection::suits(const ProjectiveSystem& system) {
  const auto& all = system.constraints;
  return !all.empty() && std::all_of(all.begin(), all.end(),
                                     [](const Constraint* c) { return c->takes_multipliers(); });
}

bool ConstrainedCorrection::needs_matrix(const ProjectiveSystem& system) {
  const auto& all = system.constraints;
  return std::any_of(all.begin(), all.end(), [](const Constraint* c) { return c->needs_matrix(); });
}

const PointConstraints& ConstrainedCorrection::collect(ProjectiveSystem& system) {
  constraints_.clear();
  for (Constraint* constraint : system.constraints) {
    constraint->add_point_constraints(system.particles.x, constraints_);
  }
  return constraints_;
}

void ConstrainedCorrection::collect_told(ProjectiveSystem& system) {
  constraints_.clear();
  for (Constraint* constraint : system.constraints) {
    if (!constraint->tells_point_constraints()) continue;
    constraint->add_point_constraints(system.particles.x, constraints_);
  }
}

void ConstrainedCorrection::follow(const Positions& d) {
  for (PointConstraint& constraint : constraints_.all) {
    const Eigen::Vector3d u = displacement(constraint, d);
    const double along = constraint.normal.dot(u);
    constraint.gap += along;
    constraint.slip += u - along * constraint.normal;
  }
}

void ConstrainedCorrection::give_multipliers(ProjectiveSystem& system) {
  for (Constraint* constraint : system.constraints) {
    if (constraint->tells_point_constraints()) constraint->take_multipliers(constraints_);
  }
}

double ConstrainedCorrection::compliance(const PointConstraint& constraint, double own) const {
  if (constraint.is_contradicted) return kContradicted * own;
  return (constraint.is_rigid ? rigid_share_ * kRigid : 1.0) * compliance_share_ * own;
}

void ConstrainedCorrection::begin(const Eigen::VectorXd& mobility) {
  states_.resize(constraints_.all.size());
  for (std::size_t c = 0; c < states_.size(); ++c) {
    const PointConstraint& constraint = constraints_.all[c];
    State& state = states_[c];
    double own = 0.0;
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& entry = constraints_.entries[static_cast<std::size_t>(e)];
      own += entry.weight * entry.weight * mobility[entry.particle];
    }
    state.compliance = state.along_normal = compliance(constraint, own);
    if (soft_answers_ != nullptr) {
      state.along_normal = compliance(constraint, soft_answer(constraint, mobility));
    }
    state.own = own;
    state.hold = Hold::kUnknown;
    state.kept = {constraint.normal_force, constraint.friction_force};
    if (own == 0.0) state.kept = {};
    state.used = state.answer = state.next = state.kept;
  }
  begin_ties(mobility);
}

double ConstrainedCorrection::soft_answer(const PointConstraint& constraint,
                                          const Eigen::VectorXd& mobility) const {
  const Eigen::Vector3d& n = constraint.normal;
  double answer = 0.0;
  for (int e = constraint.begin; e < constraint.end; ++e) {
    const auto& [particle, weight] = constraints_.entries[static_cast<std::size_t>(e)];
    if (mobility[particle] == 0.0) continue;
    const Eigen::Matrix3d& own = (*soft_answers_)[static_cast<std::size_t>(particle)];
    answer += weight * weight * std::max(mobility[particle], soft_share_ * n.dot(own * n));
  }
  return answer;
}

void ConstrainedCorrection::find_squared_violations(ProjectiveSystem& system,
                                                    const Eigen::VectorXd& mobility,
                                                    Eigen::VectorXd& violations) {
  collect(system);
  begin(mobility);
  set_bounds(0);
  moved_.setZero(3, mobility.size());
  answer(moved_, 0.0);
  violations.setZero(mobility.size());
  for (std::size_t c = 0; c < states_.size(); ++c) {
    const State& state = states_[c];
    const double normal = state.answer.normal - state.kept.normal;
    const double squared =
        normal * normal + (state.answer.friction - state.kept.friction).squaredNorm();
    const PointConstraint& constraint = constraints_.all[c];
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& [particle, weight] = constraints_.entries[static_cast<std::size_t>(e)];
      violations[particle] += weight * weight * mobility[particle] * squared;
    }
  }
  add_tie_violations(mobility, violations);
}

Eigen::Vector3d ConstrainedCorrection::displacement(const PointConstraint& constraint,
                                                    const Positions& d) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int e = constraint.begin; e < constraint.end; ++e) {
    const auto& entry = constraints_.entries[static_cast<std::size_t>(e)];
    sum += entry.weight * d.col(entry.particle);
  }
  return sum;
}

void ConstrainedCorrection::answer(const Positions& d, double share) {
  for (std::size_t c = 0; c < states_.size(); ++c) {
    State& state = states_[c];
    if (state.compliance == 0.0) continue;
    const PointConstraint& constraint = constraints_.all[c];
    if (share == 0.0) state.moved = displacement(constraint, d);
    Eigen::Vector3d u = state.moved;
    if (share != 0.0) u += share * state.moves;
    const double along = constraint.normal.dot(u);
    state.answer.normal = std::max(
        constraint.lowest, state.kept.normal - (constraint.gap + along) / state.along_normal);
    state.answer.friction =
        state.kept.friction - (constraint.slip + u - along * constraint.normal) / state.compliance;
    state.uncut = state.answer.friction.norm();
    if (state.uncut > state.bound) state.answer.friction *= state.bound / state.uncut;
  }
  answer_ties(d, share);
}

bool ConstrainedCorrection::are_held_alike() {
  bool are_alike = true;
  for (std::size_t c = 0; c < states_.size(); ++c) {
    State& state = states_[c];
    Hold hold = state.uncut > state.bound ? Hold::kSlides : Hold::kSticks;
    if (state.answer.normal <= constraints_.all[c].lowest) hold = Hold::kOpen;
    are_alike = are_alike && hold == state.hold;
    state.hold = hold;
  }
  return are_alike;
}

void ConstrainedCorrection::list_rows() {
  rows_.clear(constraints_);
  for (std::size_t t = 0; t < ties_.size(); ++t) {
    Tie& tie = ties_[t];
    tie.next = tie.answer;
    if (tie.compliance == 0.0 || tie.is_bound) continue;
    rows_.append_tie(static_cast<int>(t), tie.compliance);
  }
  const bool by_tangents = !is_cautious_ || are_held_alike();
  for (std::size_t c = 0; c < states_.size(); ++c) list_rows(static_cast<int>(c), by_tangents);
}

void ConstrainedCorrection::list_rows(int number, bool by_tangents) {
  State& state = states_[static_cast<std::size_t>(number)];
  state.next = state.answer;
  if (state.compliance == 0.0) return;
  const PointConstraint& constraint = constraints_.all[static_cast<std::size_t>(number)];
  // A row's force changes from the one that is used; its target makes up for the difference.
  if (state.answer.normal > constraint.lowest) {
    rows_.append(number, constraint.normal, state.along_normal,
                 state.along_normal * (state.answer.normal - state.used.normal));
    state.next.normal = state.used.normal;
  }
  if (state.bound == 0.0) return;
  const bool slides = state.uncut > state.bound;
  const Eigen::Vector3d along = slides ? Eigen::Vector3d(state.answer.friction.normalized())
                                       : constraint.normal.unitOrthogonal();
  const Eigen::Vector3d across = constraint.normal.cross(along);
  // The force of one that slides turns with the slip: across it, it has the stiffness b/(C |f|),
  // f before it was cut; at the least that of one that begins to. That is its secant too.
  const Eigen::Vector3d change = state.answer.friction - state.used.friction;
  const double compliance =
      slides ? state.compliance * state.uncut / state.bound : state.compliance;
  rows_.append(number, across, compliance, compliance * across.dot(change));
  state.next.friction -= across.dot(change) * across;
  if (slides && by_tangents) return;
  rows_.append(number, along, compliance, compliance * along.dot(change));
  state.next.friction = state.used.friction;
}

void ConstrainedCorrection::add_forces(Force State::*which, double sign, Forces& f) const {
  for (std::size_t c = 0; c < states_.size(); ++c) {
    const PointConstraint& constraint = constraints_.all[c];
    const Force& force = states_[c].*which;
    const Eigen::Vector3d sum = sign * (force.normal * constraint.normal + force.friction);
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& entry = constraints_.entries[static_cast<std::size_t>(e)];
      f.col(entry.particle) += entry.weight * sum;
    }
  }
}

void ConstrainedCorrection::list_points(const Eigen::VectorXd& mobility) {
  points_.clear();
  column_of_.assign(static_cast<std::size_t>(mobility.size()), -1);
  for (const PointConstraint& constraint : constraints_.all) {
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const int particle = constraints_.entries[static_cast<std::size_t>(e)].particle;
      int& column = column_of_[static_cast<std::size_t>(particle)];
      if (column >= 0 || mobility[particle] == 0.0) continue;
      column = 0;
      points_.push_back(particle);
    }
  }
  std::sort(points_.begin(), points_.end());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    column_of_[static_cast<std::size_t>(points_[k])] = static_cast<int>(k);
  }
}

void ConstrainedCorrection::select_points() {
  selected_.clear();
  selected_column_of_.assign(column_of_.size(), -1);
  for (int r = 0; r < rows_.size(); ++r) {
    for (const auto* entry = rows_.begin(r); entry != rows_.end(r); ++entry) {
      const auto particle = static_cast<std::size_t>(entry->particle);
      if (column_of_[particle] < 0 || selected_column_of_[particle] >= 0) continue;
      selected_column_of_[particle] = static_cast<int>(selected_.size());
      selected_.push_back(column_of_[particle]);
    }
  }
}

bool ConstrainedCorrection::begin_between_points(const Eigen::VectorXd& mobility,
                                                 const Inverse& p_inverse) {
  if (p_inverse.touched == nullptr) return false;
  list_points(mobility);
  select_points();
  if (!p_inverse.touched->restrict_to(points_, selected_.size())) return false;
  all_pushed_.setZero(4, static_cast<Eigen::Index>(points_.size()));
  move_.setZero(3, mobility.size());
  return true;
}

void ConstrainedCorrection::end_between_points(const LinearOperator& p_inverse, Positions& d) {
  moved_.setZero(3, d.cols());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    moved_.col(points_[k]) = all_pushed_.col(static_cast<Eigen::Index>(k)).head<3>();
  }
  p_inverse(moved_);
  d = start_ + moved_;
}

void ConstrainedCorrection::solve_rows(const Eigen::VectorXd& mobility, const Inverse& p_inverse) {
  // What the others change.
  moved_.setZero(3, mobility.size());
  add_forces(&State::next, 1.0, moved_);
  add_forces(&State::used, -1.0, moved_);
  zero_pinned(mobility, moved_);
  const Eigen::Index size = rows_.size();
  for (Eigen::VectorXd* v : {&multipliers_, &residual_, &preconditioned_, &direction_, &product_}) {
    v->setZero(size);
  }
  if (is_between_points_) {
    begin_selected(*p_inverse.touched);
  } else {
    move_ = moved_;
    if (!move_.isZero(0.0)) p_inverse.whole(move_);
    rows_.gather(move_, residual_);
  }
  for (int r = 0; r < rows_.size(); ++r) residual_[r] -= rows_.target(r);
  const double first = residual_.norm();
  if (goal_ == 0.0) goal_ = kTolerance * first;
  iterate_rows(mobility, p_inverse, std::max(goal_, kRoundTolerance * first));
  take_rows();
  if (is_between_points_) end_selected(*p_inverse.touched);
}

void ConstrainedCorrection::begin_selected(TouchedInverse& inverse) {
  pushed_.setZero(4, static_cast<Eigen::Index>(points_.size()));
  for (std::size_t k = 0; k < points_.size(); ++k) {
    pushed_.col(static_cast<Eigen::Index>(k)).head<3>() = moved_.col(points_[k]);
  }
  if (!pushed_.isZero(0.0)) {
    inverse.apply(pushed_, gone_);
    rows_.gather(gone_, column_of_, residual_);
  }
  select_points();
  inverse.select(selected_);
}

void ConstrainedCorrection::end_selected(TouchedInverse& inverse) {
  rows_.spread(-multipliers_, column_of_, pushed_);
  inverse.apply(pushed_, gone_);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    move_.col(points_[k]) = gone_.col(static_cast<Eigen::Index>(k)).head<3>();
  }
}

void ConstrainedCorrection::multiply_rows(const Eigen::VectorXd& mobility,
                                          const Inverse& p_inverse) {
  if (is_between_points_) {
    pushes_.setZero(4, static_cast<Eigen::Index>(selected_.size()));
    rows_.spread(direction_, selected_column_of_, pushes_);
    p_inverse.touched->apply_selected(pushes_, answers_);
    rows_.gather(answers_, selected_column_of_, product_);
    return;
  }
  moved_.setZero(3, mobility.size());
  rows_.spread(direction_, moved_);
  zero_pinned(mobility, moved_);
  p_inverse.whole(moved_);
  rows_.gather(moved_, product_);
}

void ConstrainedCorrection::iterate_rows(const Eigen::VectorXd& mobility, const Inverse& p_inverse,
                                         double goal) {
  double last = 1.0;
  for (int k = 0; k < kMaxIterations && residual_.norm() > goal; ++k) {
    preconditioner_.apply(residual_, preconditioned_);
    const double now = residual_.dot(preconditioned_);
    direction_ = preconditioned_ + (k == 0 ? 0.0 : now / last) * direction_;
    last = now;
    multiply_rows(mobility, p_inverse);
    for (int r = 0; r < rows_.size(); ++r) product_[r] += rows_.compliance(r) * direction_[r];
    const double curvature = direction_.dot(product_);
    if (!(curvature > 0.0)) break;
    const double step = now / curvature;
    multipliers_ += step * direction_;
    if (!is_between_points_) move_ -= step * moved_;
    residual_ -= step * product_;
    ++iterations_;
  }
}

void ConstrainedCorrection::take_rows() {
  for (int r = 0; r < rows_.size(); ++r) {
    const auto c = static_cast<std::size_t>(rows_.constraint(r));
    Force& next = states_[c].next;
    if (rows_.is_normal(r)) {
      next.normal -= multipliers_[r];
    } else {
      next.friction -= multipliers_[r] * rows_.direction(r);
    }
  }
}

bool ConstrainedCorrection::solve_matrix(const Eigen::VectorXd& mobility,
                                         const MatrixWithRows& inverse) {
  move_ = unbalanced_;
  add_forces(&State::next, 1.0, move_);
  add_forces(&State::used, -1.0, move_);
  // Eigen takes memory anew for each other size, and contacts come and go.
  if (multipliers_.size() < rows_.size()) multipliers_.resize(rows_.size());
  for (int r = 0; r < rows_.size(); ++r) multipliers_[r] = rows_.target(r) / rows_.compliance(r);
  rows_.spread(multipliers_, move_);
  // What ties answer already; the matrix adds what they answer to the round's displacement.
  add_tie_forces(&Tie::next, 1.0, move_);
  add_tie_forces(&Tie::used, -1.0, move_);
  zero_pinned(mobility, move_);
  if (!inverse(rows_, move_, left_)) return false;
  find_tie_forces();
  rows_.gather(move_, multipliers_);
  for (int r = 0; r < rows_.size(); ++r) {
    multipliers_[r] = (multipliers_[r] - rows_.target(r)) / rows_.compliance(r);
  }
  take_rows();
  return true;
}

double ConstrainedCorrection::work(Force State::*which) const {
  double sum = 0.0;
  for (std::size_t c = 0; c < states_.size(); ++c) {
    const Force& force = states_[c].*which;
    sum += states_[c].moves.dot(force.normal * constraints_.all[c].normal + force.friction);
  }
  return sum;
}

double ConstrainedCorrection::search(const Positions& d) {
  for (std::size_t c = 0; c < states_.size(); ++c) {
    states_[c].moves = displacement(constraints_.all[c], move_);
  }
  // The slope of the function along the move; it rises with the share, since that is convex.
  const double used = work(&State::used) + work(&Tie::used);
  const double next = work(&State::next) + work(&Tie::next);
  // What is not balanced yet, and what is not after the whole of the move.
  const double lacks = is_cautious_ ? unbalanced_.cwiseProduct(move_).sum() : 0.0;
  const double leaves = is_cautious_ ? left_.cwiseProduct(move_).sum() : 0.0;
  const auto slope = [&](double share) {
    if (share != 0.0) answer(d, share);
    return used + share * (next - used) - work(&State::answer) - work(&Tie::answer) -
           (lacks + share * (leaves - lacks));
  };
  const double at_start = slope(0.0);
  double low = 0.0, low_slope = at_start, high = 1.0, high_slope = slope(1.0);
  if (!(at_start < 0.0) || high_slope <= kFlat * std::abs(at_start)) return 1.0;
  for (int k = 0; k < kMaxTrials; ++k) {
    // By the secant, not too near to either end.
    const double secant = low + (high - low) * low_slope / (low_slope - high_slope);
    const double width = high - low;
    const double share = std::clamp(secant, low + 0.05 * width, high - 0.05 * width);
    const double here = slope(share);
    if (std::abs(here) <= kFlat * std::abs(at_start)) return share;
    (here < 0.0 ? low : high) = share;
    (here < 0.0 ? low_slope : high_slope) = here;
  }
  return low > 0.0 ? low : high;
}

bool ConstrainedCorrection::is_settled(bool first) const {
  double left = 0.0, done = 0.0, all = 0.0;
  for (const State& state : states_) {
    const auto squared = [](const Force& a, const Force& b) {
      return (a.normal - b.normal) * (a.normal - b.normal) +
             (a.friction - b.friction).squaredNorm();
    };
    left += squared(state.answer, state.used);
    done += squared(state.answer, state.kept);
    all += squared(state.answer, {});
  }
  for (const Tie& tie : ties_) {
    // In the units of forces on points: those of their directions, of length 1 together.
    const double scale = tie.scale * tie.scale;
    left += scale * (tie.answer - tie.used) * (tie.answer - tie.used);
    done += scale * (tie.answer - tie.kept) * (tie.answer - tie.kept);
    all += scale * tie.answer * tie.answer;
  }
  // Forces that turn out to be needless leave nothing.
  return left <= kSettled * kSettled * all ||
         (!first && left <= settled_share_ * settled_share_ * std::min(done, all));
}

void ConstrainedCorrection::set_bounds(int round) {
  for (std::size_t c = 0; c < states_.size(); ++c) {
    State& state = states_[c];
    const PointConstraint& constraint = constraints_.all[c];
    // The first round knows the normal forces of the last correction, the others their own.
    const double normal = round == 0 ? state.kept.normal : state.used.normal;
    const double bound = constraint.friction * std::max(0.0, normal - constraint.lowest);
    const bool is_plain = !is_cautious_ || round < kPlainRounds;
    state.bound = is_plain ? bound : 0.5 * (state.bound + bound);
  }
}

double ConstrainedCorrection::move(Positions& d, bool searches) {
  const double share = searches ? search(d) : 1.0;
  d += share * move_;
  if (is_between_points_) all_pushed_ += share * pushed_;
  for (State& state : states_) {
    state.used.normal += share * (state.next.normal - state.used.normal);
    state.used.friction += share * (state.next.friction - state.used.friction);
  }
  for (Tie& tie : ties_) tie.used += share * (tie.next - tie.used);
  return share;
}

void ConstrainedCorrection::keep_multipliers(const Eigen::VectorXd& mobility, Eigen::Index size) {
  for (std::size_t c = 0; c < states_.size(); ++c) {
    // The last round's bound was that of the normal force before it.
    Force& used = states_[c].used;
    const double bound =
        constraints_.all[c].friction * std::max(0.0, used.normal - constraints_.all[c].lowest);
    const double size = used.friction.norm();
    if (size > bound && size <= (1.0 + kBoundRoundOff) * bound) used.friction *= bound / size;
  }
  for (std::size_t c = 0; c < states_.size(); ++c) {
    constraints_.all[c].normal_force = states_[c].used.normal;
    constraints_.all[c].friction_force = states_[c].used.friction;
  }
  for (std::size_t t = 0; t < ties_.size(); ++t) constraints_.ties[t].force = ties_[t].used;
  forces_.setZero(3, size);
  add_forces(&State::used, 1.0, forces_);
  add_tie_forces(&Tie::used, 1.0, forces_);
  zero_pinned(mobility, forces_);
}

double ConstrainedCorrection::reached_share(const Positions& d) const {
  double share = 1.0;
  for (const TyingConstraint& tie : constraints_.ties) {
    for (int e = tie.begin; e < tie.end; ++e) {
      const int particle = constraints_.gradients[static_cast<std::size_t>(e)].particle;
      const double distance = d.col(particle).norm();
      if (distance * share > tie.reach) share = tie.reach / distance;
    }
  }
  return share;
}

void ConstrainedCorrection::tell_constraints(ProjectiveSystem& system) {
  for (Constraint* constraint : system.constraints) constraint->take_multipliers(constraints_);
}

void ConstrainedCorrection::solve(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                  const Eigen::VectorXd& own_answers, const RigidModes& modes,
                                  const Inverse& p_inverse, Eigen::Matrix3Xd& d) {
  begin(mobility);
  // First with the forces that are known already.
  add_forces(&State::used, 1.0, d);
  zero_pinned(mobility, d);
  p_inverse.whole(d);
  goal_ = 0.0;
  is_between_points_ = false;
  for (int round = 0; round < kMaxRounds; ++round) {
    set_bounds(round);
    answer(d, 0.0);
    if (is_settled(round == 0)) break;
    list_rows();
    if (round == 0) {
      is_between_points_ = begin_between_points(mobility, p_inverse);
      start_ = d;
    }
    preconditioner_.prepare(rows_, own_answers, modes, system.responders);
    solve_rows(mobility, p_inverse);
    move(d, true);
  }
  if (is_between_points_) end_between_points(p_inverse.whole, d);
  keep_multipliers(mobility, d.cols());
  tell_constraints(system);
}

bool ConstrainedCorrection::solve(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                  const MatrixWithRows& inverse, Eigen::Matrix3Xd& d) {
  if (!find(kMaxRounds, mobility, inverse, d)) return false;
  tell_constraints(system);
  return true;
}

void ConstrainedCorrection::take_back(ProjectiveSystem& system) {
  for (std::size_t c = 0; c < states_.size(); ++c) {
    constraints_.all[c].normal_force = states_[c].kept.normal;
    constraints_.all[c].friction_force = states_[c].kept.friction;
  }
  for (std::size_t t = 0; t < ties_.size(); ++t) constraints_.ties[t].force = ties_[t].kept;
  tell_constraints(system);
}

bool ConstrainedCorrection::find(int rounds, const Eigen::VectorXd& mobility,
                                 const MatrixWithRows& inverse, Eigen::Matrix3Xd& d) {
  begin(mobility);
  is_balanced_ = is_between_points_ = false;
  unbalanced_ = d;
  add_forces(&State::used, 1.0, unbalanced_);
  add_tie_forces(&Tie::used, 1.0, unbalanced_);
  d.setZero();
  is_found_ = false;
  for (int round = 0; round < rounds; ++round) {
    set_bounds(round);
    answer(d, 0.0);
    is_found_ = is_balanced_ && is_settled(false);
    if (is_found_) break;
    list_rows();
    if (!solve_matrix(mobility, inverse)) return false;
    // The first displacement is the first that is in balance: only cautious rounds know what there
    // is to compare it with.
    const double share = move(d, is_cautious_ || round > 0);
    unbalanced_ += share * (left_ - unbalanced_);
    is_balanced_ = is_balanced_ || share == 1.0;
  }
  keep_multipliers(mobility, d.cols());
  return true;
}

}  // namespace pliant
