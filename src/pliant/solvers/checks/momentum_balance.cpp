#include "pliant/solvers/checks/momentum_balance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/core/columns.h"

namespace pliant {
namespace {

// Compliance of contacts as a share of a vertex's own answer to a force: at a step's beginning all
// of it, so that a soft place gives way; at its end less, since gaps are closed then.
constexpr double kSoft = 1.0, kHard = 0.25;
// Each goes on from the multipliers of the one before, so that gaps close whatever the compliance
// is, until motions are that share of the first one.
constexpr int kPasses = 2, kRigidPasses = 4;
constexpr double kLeft = 1e-3;
constexpr int kRounds = 40;
// What a pass may leave out of balance, as a share of what it changed of the forces.
constexpr double kRough = 1e-2, kAccuracy = 1e-6;

// Of the sum of what is added up: a sum that is round-off.
constexpr double kRoundOff = 1e-15;

// Of Coulomb's bound: a friction force below it holds its point. Forces of a GPU are no more exact.
constexpr double kSticks = 1.0 - 1e-5;

/// What contacts carry is what holds them where they are.
void take_as_held(PointConstraints& constraints) {
  for (PointConstraint& constraint : constraints.all) {
    const double pressing = constraint.normal_force - constraint.lowest;
    constraint.gap = pressing > 0.0 ? 0.0 : std::max(0.0, constraint.gap);
    const double bound = constraint.friction * pressing;
    const bool sticks = constraint.friction_force.norm() < kSticks * bound;
    if (sticks) constraint.slip.setZero();
  }
}

}  // namespace

void MomentumBalance::prepare(const ProjectiveSystem& system, double dt) {
  Components components = find_components(system);
  for (int c = 0; c < components.count(); ++c) {
    const auto k = static_cast<std::size_t>(c);
    // A vertex that nothing ties to others answers forces by its own inertia in any case.
    if (components.begins[k + 1] - components.begins[k] == 1) components.held[k] = true;
  }
  rigid_.prepare(std::move(components), system.particles.mass / (dt * dt));
  is_missed_ = false;
  numbers_.assign(is_used() ? static_cast<std::size_t>(system.particles.size()) : 0, -1);
}

void MomentumBalance::compare(const ProjectiveSystem& system, double dt) {
  is_missed_ = false;
  if (!is_used()) return;
  const Particles& p = system.particles;
  const Positions& origin = p.x_inertial();
  const Eigen::Matrix3Xd& velocity = p.v_inertial();
  rigid_.place(p.mass, 1.0 / (dt * dt), p.x);
  const bool forced = !system.constraints.empty();
  if (forced) work_.setZero(3, p.size());
  for (const Constraint* constraint : system.constraints) constraint->add_forces(work_);
  // f/h + m/h² (v_predicted − v): what velocities lack, times m/h².
  const auto predicted = [&](int i) -> Eigen::Vector3d {
    return velocity.col(i) + dt * p.inverse_mass[i] * system.external_forces.col(i);
  };
  const auto lacks = [&](int i) -> Eigen::Vector3d {
    const Eigen::Vector3d v = (p.x.col(i) - origin.col(i)) / dt;
    const Eigen::Vector3d inner = p.mass[i] / (dt * dt) * (predicted(i) - v);
    return forced ? Eigen::Vector3d(inner + work_.col(i) / dt) : inner;
  };
  double size = 0.0;
  for (int i = 0; i < p.size(); ++i) {
    size +=
        p.mass[i] / (dt * dt) * (predicted(i).norm() + (p.x.col(i) - origin.col(i)).norm() / dt);
    if (forced) size += work_.col(i).norm() / dt;
  }
  find_turning(p, dt);
  is_missed_ = modes().find_motions(lacks, turning_, kRoundOff * size, missed_);
}

// A step keeps the momentum by itself, but not the angular momentum: that shall follow the formula
// of the velocities too, L = L* + h* τ with L* of the angular momenta L before as v* is of the
// velocities before. What m x × v* lacks of L* is of third order in h with BDF2.
void MomentumBalance::find_turning(const Particles& p, double dt) {
  turning_.clear();
  if (!p.inertia.is_used) return;
  turning_.assign(static_cast<std::size_t>(modes().count()), Eigen::Vector3d::Zero());
  const double share = p.inertia.share;
  for (int i = 0; i < p.size(); ++i) {
    const int body = modes().body_of(i);
    if (body < 0) continue;
    // About the component's centre at the end.
    const Eigen::Vector3d arm = modes().arm(i);
    const Eigen::Vector3d start = p.x_start.col(i) - (p.x.col(i) - arm);
    const Eigen::Vector3d v = p.v_start.col(i), v_inertial = p.v_inertial().col(i);
    Eigen::Vector3d inertial = start.cross(v);
    if (share > 0.0) {
      const Eigen::Vector3d moved = (p.x_inertial().col(i) - p.x_start.col(i)) / share;
      const Eigen::Vector3d before = v - (v_inertial - v) / share;
      inertial += share * (inertial - (start - moved).cross(before));
    }
    turning_[static_cast<std::size_t>(body)] +=
        p.mass[i] / (dt * dt) * (inertial - arm.cross(v_inertial));
  }
}

bool MomentumBalance::correct_velocities(ProjectiveSystem& system) {
  if (!std::exchange(is_missed_, false)) return false;
  for (int i = 0; i < system.particles.size(); ++i) {
    const int body = modes().body_of(i);
    if (body >= 0) system.particles.v.col(i) += modes().motion(i, missed_.segment<6>(6 * body));
  }
  return true;
}

bool MomentumBalance::is_missed_by(double share, const ProjectiveSystem& system, double dt) const {
  return is_missed_ && missed_norm(true, true) > share * motion(system, dt);
}

void MomentumBalance::lose_above(double share, const ProjectiveSystem& system, double dt) {
  if (!is_missed_) return;
  const double most = share * motion(system, dt);
  const bool shifts = missed_norm(true, false) <= most, turns = missed_norm(false, true) <= most;
  for (int b = 0; b < modes().count(); ++b) {
    if (!shifts) missed_.segment<3>(6 * b).setZero();
    if (!turns) missed_.segment<3>(6 * b + 3).setZero();
  }
  is_missed_ = shifts || turns;
}

double MomentumBalance::missed_norm(bool shifts, bool turns) const {
  double squared = 0.0;
  for (int b = 0; b < modes().count(); ++b) {
    RigidModes::Vector6 motion = missed_.segment<6>(6 * b);
    if (!shifts) motion.head<3>().setZero();
    if (!turns) motion.tail<3>().setZero();
    squared += motion.dot(modes().inertia(b) * motion);
  }
  return std::sqrt(squared);
}

double MomentumBalance::motion(const ProjectiveSystem& system, double dt) const {
  const Particles& p = system.particles;
  double squared = 0.0;
  for (int i = 0; i < p.size(); ++i) {
    if (modes().body_of(i) < 0) continue;
    const double gained = dt * p.inverse_mass[i] * system.external_forces.col(i).norm();
    squared += p.mass[i] / (dt * dt) * (p.v.col(i).squaredNorm() + gained * gained);
  }
  return std::sqrt(squared);
}

void MomentumBalance::number_vertices(const Eigen::VectorXd& mobility) {
  vertices_.clear();
  for (PointConstraints::Entry& entry : contacts_.constraints().entries) {
    int& number = numbers_[static_cast<std::size_t>(entry.particle)];
    if (number < 0) {
      number = static_cast<int>(vertices_.size());
      vertices_.push_back(entry.particle);
    }
    entry.particle = static_cast<int>(vertex_column(number));
  }
  // Twice as much each time, so that memory is seldom taken.
  const auto count = static_cast<Eigen::Index>(vertices_.size());
  while (room_ < count) room_ = std::max<Eigen::Index>(16, 2 * room_);
  mobility_.setZero(vertex_column(room_));
  // Those of components are not pinned.
  mobility_.head(vertex_column(0)).setOnes();
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    mobility_[vertex_column(static_cast<Eigen::Index>(k))] = mobility[vertices_[k]];
    numbers_[static_cast<std::size_t>(vertices_[k])] = -1;
  }
}

void MomentumBalance::find_unbalanced(const ProjectiveSystem& system, double dt,
                                      Eigen::Matrix3Xd& d) {
  const Particles& p = system.particles;
  const Positions& origin = p.x_inertial();
  const Eigen::Matrix3Xd& velocity = p.v_inertial();
  const auto tells = [](const Constraint* constraint) {
    return constraint->tells_point_constraints();
  };
  const bool forced = !std::all_of(system.constraints.begin(), system.constraints.end(), tells);
  if (forced) work_.setZero(3, p.size());
  for (const Constraint* constraint : system.constraints) {
    if (!constraint->tells_point_constraints()) constraint->add_forces(work_);
  }
  d.setZero(3, vertex_column(room_));
  for (int i = 0; i < p.size(); ++i) {
    const int body = modes().body_of(i);
    if (body < 0) continue;
    const Eigen::Vector3d predicted =
        origin.col(i) +
        dt * (velocity.col(i) + dt * p.inverse_mass[i] * system.external_forces.col(i));
    Eigen::Vector3d force = p.mass[i] / (dt * dt) * (predicted - p.x.col(i));
    if (forced) force += work_.col(i);
    const RigidModes::Vector6 sum = modes().project(i, force);
    d.col(body_column(body)) += sum.head<3>();
    d.col(body_column(body) + 1) += sum.tail<3>();
  }
}

bool MomentumBalance::solve(const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left) {
  springs_.clear();
  for (int r = 0; r < rows.size(); ++r) {
    springs_.begin_row(1.0 / rows.compliance(r));
    for (const auto* e = rows.begin(r); e != rows.end(r); ++e) {
      if (mobility_[e->particle] == 0.0) continue;
      springs_.add(vertex_of(e->particle), e->weight * rows.direction(r));
    }
  }
  rigid_.factor(springs_);
  for (int b = 0; b < modes().count(); ++b) {
    motions_.segment<3>(6 * b) = v.col(body_column(b));
    motions_.segment<3>(6 * b + 3) = v.col(body_column(b) + 1);
  }
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const int body = modes().body_of(vertices_[k]);
    if (body < 0) continue;
    motions_.segment<6>(6 * body) +=
        modes().project(vertices_[k], v.col(vertex_column(static_cast<Eigen::Index>(k))));
  }
  rigid_.find_motions(motions_);
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const int body = modes().body_of(vertices_[k]);
    auto motion = v.col(vertex_column(static_cast<Eigen::Index>(k)));
    motion.setZero();
    if (body >= 0) motion = modes().motion(vertices_[k], motions_.segment<6>(6 * body));
  }
  for (int b = 0; b < modes().count(); ++b) {
    v.col(body_column(b)) = motions_.segment<3>(6 * b);
    v.col(body_column(b) + 1) = motions_.segment<3>(6 * b + 3);
  }
  left.setZero(3, v.cols());
  return true;
}

void MomentumBalance::find_motions(const ProjectiveSystem& system, double dt) {
  rigid_.place(system.particles.mass, 1.0 / (dt * dt), system.particles.x);
  find_unbalanced(system, dt, moved_);
  motions_.resize(6 * modes().count());
  sums_.resize(6 * modes().count());
  for (int b = 0; b < modes().count(); ++b) {
    sums_.segment<3>(6 * b) = moved_.col(body_column(b));
    sums_.segment<3>(6 * b + 3) = moved_.col(body_column(b) + 1);
  }
  begun_ = contacts_.constraints().all;
  if (rigid_.is_too_much() || (!find_motions_together())) find_motions_in_turns();
  contacts_.follow(moved_);
  for (int b = 0; b < modes().count(); ++b) {
    motions_.segment<3>(6 * b) = moved_.col(body_column(b));
    motions_.segment<3>(6 * b + 3) = moved_.col(body_column(b) + 1);
  }
}

bool MomentumBalance::find_motions_together() {
  contacts_.find(
      kRounds, mobility_,
      [this](const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left) {
        return solve(rows, v, left);
      },
      moved_);
  return contacts_.is_found();
}

void MomentumBalance::find_motions_in_turns() {
  PointConstraints& constraints = contacts_.constraints();
  turns_.begin(sums_);
  for (const PointConstraint& constraint : begun_) {
    double own = 0.0;
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& entry = constraints.entries[static_cast<std::size_t>(e)];
      own += entry.weight * entry.weight * mobility_[entry.particle];
    }
    turns_.append(constraint, contacts_.compliance(constraint, own));
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& entry = constraints.entries[static_cast<std::size_t>(e)];
      if (mobility_[entry.particle] == 0.0) continue;
      turns_.add(modes(), vertex_of(entry.particle), entry.weight);
    }
  }
  turns_.solve(modes());
  for (std::size_t c = 0; c < begun_.size(); ++c) {
    constraints.all[c].normal_force = turns_.normal_force(c);
    constraints.all[c].friction_force = turns_.friction_force(c);
  }
  set_moved(turns_.motions());
}

void MomentumBalance::set_moved(const Eigen::VectorXd& motions) {
  for (int b = 0; b < modes().count(); ++b) {
    moved_.col(body_column(b)) = motions.segment<3>(6 * b);
    moved_.col(body_column(b) + 1) = motions.segment<3>(6 * b + 3);
  }
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const int body = modes().body_of(vertices_[k]);
    auto motion = moved_.col(vertex_column(static_cast<Eigen::Index>(k)));
    motion.setZero();
    if (body >= 0) motion = modes().motion(vertices_[k], motions.segment<6>(6 * body));
  }
}

void MomentumBalance::close_gaps(Positions& x) {
  closed_.setZero(3, vertex_column(room_));
  const PointConstraints& constraints = contacts_.constraints();
  for (const PointConstraint& constraint : constraints.all) {
    if (constraint.gap >= 0.0) continue;
    double own = 0.0;
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& entry = constraints.entries[static_cast<std::size_t>(e)];
      own += entry.weight * entry.weight * mobility_[entry.particle];
    }
    if (own == 0.0) continue;
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& entry = constraints.entries[static_cast<std::size_t>(e)];
      closed_.col(entry.particle) -=
          constraint.gap * entry.weight * mobility_[entry.particle] / own * constraint.normal;
    }
  }
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    x.col(vertices_[k]) += closed_.col(vertex_column(static_cast<Eigen::Index>(k)));
  }
}

double MomentumBalance::friction_work() {
  double sum = 0.0;
  for (const PointConstraint& constraint : contacts_.constraints().all) {
    const double pressing = std::max(0.0, constraint.normal_force - constraint.lowest);
    sum += constraint.friction * pressing * constraint.slip.norm();
  }
  return sum;
}

void MomentumBalance::begin(ProjectiveSystem& system, const StepObjective& objective,
                            const Eigen::VectorXd& mobility, double dt) {
  if (!is_used()) return;
  for (Constraint* constraint : system.constraints) {
    // Only contacts go on with the forces of the last step.
    constraint->reset_multipliers();
    constraint->warm_start();
  }
  contacts_.collect_told(system);
  if (contacts_.constraints().all.empty()) return;
  Positions& x = system.particles.x;
  number_vertices(mobility);
  work_ = x;
  close_gaps(x);
  const double alone = objective.value(system);
  x = work_;
  contacts_.set_compliance(kSoft);
  contacts_.set_accuracy(kRough);
  find_motions(system, dt);
  const double less_friction = friction_work();
  moved_ *= -1.0;
  contacts_.follow(moved_);
  const double saved = friction_work() - less_friction;
  moved_ *= -1.0;
  contacts_.follow(moved_);
  work_ = x;
  modes().move(motions_, x);
  close_gaps(x);
  const double together = objective.value(system);
  x = work_;
  if (together - saved < alone) modes().move(motions_, x);
}

template <class BeginPass>
void MomentumBalance::find_balance(ProjectiveSystem& system, double dt, int passes,
                                   const BeginPass& begin_pass) {
  contacts_.set_compliance(kHard);
  contacts_.set_accuracy(kAccuracy);
  rigid_.place(system.particles.mass, 1.0 / (dt * dt), system.particles.x);
  double first = 0.0;
  for (int pass = 0; pass < passes; ++pass) {
    begin_pass(pass);
    find_motions(system, dt);
    modes().move(motions_, system.particles.x);
    double size = 0.0;
    for (int b = 0; b < modes().count(); ++b) {
      const RigidModes::Vector6 motion = motions_.segment<6>(6 * b);
      size += motion.dot(modes().inertia(b) * motion);
    }
    if (pass == 0) first = size;
    if (size <= kLeft * kLeft * first) break;
  }
  contacts_.give_multipliers(system);
}

void MomentumBalance::restore(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                              double dt) {
  if (!is_used()) return;
  contacts_.collect_told(system);
  take_as_held(contacts_.constraints());
  number_vertices(mobility);
  find_balance(system, dt, kPasses, [](int) {});
}

bool MomentumBalance::can_move_rigidly(const ProjectiveSystem& system) const {
  const auto tells = [](const Constraint* c) {
    return c->is_idle() || c->tells_point_constraints();
  };
  return is_used() && system.responders.empty() &&
         std::all_of(system.constraints.begin(), system.constraints.end(), tells);
}

void MomentumBalance::forget_multipliers() {
  PointConstraints& constraints = contacts_.constraints();
  for (PointConstraint& constraint : constraints.all) {
    bool is_free = false;
    for (int e = constraint.begin; e < constraint.end; ++e) {
      const auto& entry = constraints.entries[static_cast<std::size_t>(e)];
      is_free = is_free || modes().body_of(entry.particle) >= 0;
    }
    if (!is_free) continue;
    constraint.normal_force = 0.0;
    constraint.friction_force.setZero();
  }
}

void MomentumBalance::move_rigidly(ProjectiveSystem& system, const Positions& ends, double share,
                                   const Eigen::VectorXd& mobility, double dt) {
  Particles& p = system.particles;
  const double scale = 1.0 / (dt * dt);
  rigid_.let_all_turn(true);
  rigid_.place(p.mass, scale, p.x_start);
  modes().find_motions(
      [&](int i) -> Eigen::Vector3d {
        return scale * p.mass[i] * (ends.col(i) - p.x_start.col(i));
      },
      {}, 0.0, motions_);
  for_each_column(p.x, [&](int i) {
    const int body = modes().body_of(i);
    if (body < 0) {
      p.x.col(i) = ends.col(i);
      return;
    }
    const Eigen::Vector3d change =
        ends.col(i) - p.x_start.col(i) - modes().motion(i, motions_.segment<6>(6 * body));
    p.x.col(i) = p.x_start.col(i) + share * change;
  });
  find_balance(system, dt, kRigidPasses, [&](int pass) {
    // Gaps are found anew, since bodies may turn far in a step.
    if (pass > 0) contacts_.give_multipliers(system);
    contacts_.collect_told(system);
    if (pass == 0) forget_multipliers();
    number_vertices(mobility);
    // Compliances are shares of what answers here: the inertia of whole components.
    for (std::size_t k = 0; k < vertices_.size(); ++k) {
      if (modes().body_of(vertices_[k]) < 0) continue;
      double& own = mobility_[vertex_column(static_cast<Eigen::Index>(k))];
      own = std::min(own, modes().translation(vertices_[k]));
    }
  });
  rigid_.let_all_turn(false);
}

}  // namespace pliant
