#include "pliant/solvers/checks/step_error.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/columns.h"
#include "pliant/solvers/components/rigid_clusters.h"
#include "pliant/solvers/linear/matrix_rows.h"
#include "pliant/solvers/linear/projective_matrix.h"

namespace pliant {
namespace {

// Of a particle's 1/D: how compliant directions are that are held.
constexpr double kCompliance = 0.25;
// Of the correction's residual: an estimate need not be exact.
constexpr double kTolerance = 1e-3;
// Work of an estimate, a block of its matrix at a time, over the visit of an entry of the elements'
// own ones, of which a solver's iteration makes as many as ElementSet::work() says: to find the
// matrices, and in each iteration of conjugate gradients. Measured on a beam of tetrahedra, a ball
// that fingers hold, cloth and clusters. Rows that are held cost more.
constexpr double kMatrixWork = 500.0, kGradientsWork = 4.5, kRowWork = 0.75;
// Of a solver's iteration beside its elements: in itself, and of each contact, of which a rigid box
// on the ground has hundreds.
constexpr double kIterationWork = 40.0, kContactWork = 25.0;
// The first of what particles of clusters share.
constexpr double kSharedWork = 80.0;
// Of a correction, until contacts settle: of one body, and of several, which slide on each other,
// of a rigid one, which the rim of a can carries at sixty points, or of particles, of which many
// touch at once. Where they end before, forces stand that no contact gives: the estimate of cloth
// over a ball and a box was up to ten times too large with 20 rounds, by chance, and twice with 40.
constexpr int kRounds = 12, kManyRounds = 40;
// Of random scenes of solids, 95 in 100 are then off by less than three times the estimate, and of
// the warned ones few by less than 2 %.
constexpr double kCalibration = 2.0;
// Time for which bodies in contact keep the velocity that they should not have [s].
constexpr double kResting = 0.1, kRestingOnParticles = 0.04;
// Of a body's size: the least distance that errors are compared with.
constexpr double kSizeShare = 1e-2;

// A Hessian takes a kilobyte a particle and more.
constexpr int kMostParticles = 30000;

// Clusters of no more particles are no body of clusters.
constexpr std::size_t kFewParticles = 8;

// Stiffness of a rigid body's edges over that of the places at their ends. What such a body bends
// and springs back by is no motion of a rigid one.
constexpr double kRigid = 100.0;

}  // namespace

void StepErrorEstimate::prepare(const ProjectiveSystem& system) {
  is_stale_ = true;
  iteration_ = 0.0;
  for (const auto& set : system.elements) iteration_ += set->work();
  int particles = system.particles.size();
  // Those of bodies of coordinates are pinned here.
  for (const auto& responder : system.responders) particles -= responder.size();
  find_pieces(system);
  int loose = 0, tied = 0;
  for (const int piece : piece_of_) {
    if (piece >= 0) ++(piece == loose_piece() ? loose : tied);
  }
  suits_ = tied > 0 && particles <= kMostParticles && tied >= loose && !system.flows();
}

void StepErrorEstimate::find_pieces(const ProjectiveSystem& system) {
  const Components components = find_components(system);
  const Pieces pieces(components, system.particles.mass);
  rigid_bend_.prepare(system, components);
  rigid_turns_.prepare(system);
  piece_of_ = Pieces::of_particles(components);
  // What deformations are off swings back: only free bodies go on as they move.
  pieces_.assign(static_cast<std::size_t>(pieces.count()), Piece());
  for (int i = 0; i < system.particles.size(); ++i) {
    const int piece = piece_of_[static_cast<std::size_t>(i)];
    if (piece < 0 || piece == loose_piece()) continue;
    const int component = components.of[static_cast<std::size_t>(i)];
    pieces_[static_cast<std::size_t>(piece)].is_free =
        !components.held[static_cast<std::size_t>(component)];
  }
  has_clusters_ = false;
  rigid_edges_.clear();
  for_each_cluster(system, [this](const SharedEntries& cluster) {
    if (is_rigid(cluster)) {
      list_edges(cluster);
    } else if (cluster.members.size() > kFewParticles) {
      const int piece = piece_of_[static_cast<std::size_t>(cluster.members.front().particle)];
      has_clusters_ = true;
      if (piece >= 0) pieces_[static_cast<std::size_t>(piece)].has_clusters = true;
    }
  });
}

void StepErrorEstimate::list_edges(const SharedEntries& rigid) {
  for (const auto& a : rigid.members) {
    for (const auto& b : rigid.members) {
      if (a.particle >= b.particle) continue;
      rigid_edges_.push_back({a.particle, b.particle, Eigen::Vector3d::Zero()});
    }
  }
}

void StepErrorEstimate::prepare(const ProjectiveSystem& system, double dt) {
  objective_.prepare(system, dt);
  hessian_.prepare();
  constrained_.set_cautious(true);
  mobility_ = kCompliance * free_mobility(objective_.diagonal(), system.particles);
  // Anew: what others move may be said only after a system was prepared.
  find_pieces(system);
  is_stale_ = false;
}

void StepErrorEstimate::predict(const ProjectiveSystem& system, double dt) {
  const Particles& p = system.particles;
  const Positions& origin = p.x_inertial();
  const Eigen::Matrix3Xd& velocity = p.v_inertial();
  places_.resize(3, p.size());
  for_each_column(places_, [&](int i) {
    const double w = p.inverse_mass[i];
    places_.col(i) = p.x.col(i);
    if (w == 0.0) return;
    places_.col(i) =
        origin.col(i) + dt * (velocity.col(i) + dt * w * system.external_forces.col(i));
  });
}

double StepErrorEstimate::work() const {
  const double work = kMatrixWork * hessian_.entries() + kSharedWork * hessian_.shared() +
                      kGradientsWork * iterations_ * (hessian_.entries() + hessian_.shared());
  return work / (kIterationWork + iteration_ + kContactWork * contacts_);
}

double StepErrorEstimate::estimate(ProjectiveSystem& system, double dt, const Elapsed& elapsed) {
  if (is_stale_) prepare(system, dt);
  contacts_ = 0;
  for (const Constraint* constraint : system.constraints) contacts_ += constraint->active();
  predict(system, dt);
  objective_.begin_step(places_);
  unused_.begin_substep();
  unused_.phases.clear();
  objective_.forces(system, forces_, unused_);
  for (Edge& edge : rigid_edges_) {
    edge.along = (system.particles.x.col(edge.b) - system.particles.x.col(edge.a)).normalized();
  }
  // The exact one of a compressed body may be nearly singular, and then says anything.
  const Positions& x = system.particles.x;
  hessian_.assemble(system, x, objective_.inertia(), Definiteness::kProjected);
  iterations_ = 0.0;
  if (!find_correction(system)) return -1.0;
  hessian_.multiply(correction_, missed_);
  places_ = x + correction_;
  followed_.keep(forces_, correction_);
  if (!follow(system, dt, elapsed)) return -1.0;
  begin_coasting(system);
  return worst(system, followed_, false);
}

double StepErrorEstimate::recount(const ProjectiveSystem& system, double dt,
                                  const Elapsed& elapsed) {
  followed_.go_back_to(forces_, correction_);
  if (!follow(system, dt, elapsed)) return -1.0;
  begin_coasting(system);
  return worst(system, followed_, false);
}

bool StepErrorEstimate::follow(const ProjectiveSystem& system, double dt, const Elapsed& elapsed) {
  const double last = elapsed.last, before = elapsed.before;
  rigid_turns_.find(system.particles, before + last);
  followed_.turn(rigid_turns_);
  if (elapsed.missing >= before) {
    return follow(system, dt, before + last, elapsed.missing + last, followed_);
  }
  return follow(system, dt, before, elapsed.missing, followed_) &&
         follow(system, dt, last, last, followed_);
}

double StepErrorEstimate::later(ProjectiveSystem& system, double dt, double steps) {
  if (is_stale_) prepare(system, dt);
  const bool touches = find_held(system);
  const double further = std::max(0.0, steps - coasted_);
  coasted_ = std::max(steps, coasted_);
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const int piece = static_cast<int>(k);
    if (!pieces_[k].is_free) continue;
    if (touches) {
      const double resting = pieces_[k].has_clusters ? kRestingOnParticles : kResting;
      coasting_.go_on(piece, further, held_, resting / dt);
    } else {
      coasting_.go_on(piece, further);
    }
  }
  return worst(system, followed_, true);
}

double StepErrorEstimate::lasting(const ProjectiveSystem& system, double dt, double seconds) {
  const double steps = std::clamp(seconds, dt, std::max(dt, FollowedError::kHorizon)) / dt;
  lasting_.begin();
  if (!follow(system, dt, steps, steps, lasting_)) return -1.0;
  return worst(system, lasting_, false);
}

bool StepErrorEstimate::follow(const ProjectiveSystem& system, double dt, double steps,
                               double missing, FollowedError& followed) {
  const double solved = are_doubled_ ? 0.5 * steps : steps;
  inertia_ = objective_.inertia() / (solved * solved);
  // At the corrected positions: where iterations ended early, stretches that are not there make
  // sheets stiff against bending.
  hessian_.assemble(system, places_, inertia_, Definiteness::kProjected);
  hold(rows_);
  const FollowedError::Missed what = {
      missed_, objective_.inertia(), constrained_.constraints(), rows_, mobility_,
      dt,      are_doubled_};
  const bool is_found = followed.follow(hessian_, what, steps, missing, kTolerance);
  count_work(followed.iterations());
  return is_found;
}

void StepErrorEstimate::ask_constraints(ProjectiveSystem& system) {
  constrained_.begin_step();
  constrained_.collect_told(system);
  held_.find(constrained_.constraints(), piece_of_, static_cast<int>(pieces_.size()));
  if (rigid_bend_.is_used()) {
    rigid_bend_.bend(constrained_.constraints(), system.particles.x);
  }
  held_.close_grips(piece_of_, constrained_.constraints());
  held_rows_.clear();
  for (Constraint* constraint : system.constraints) {
    if (constraint->tells_point_constraints()) continue;
    constraint->add_rows(system.particles.x, held_rows_);
    constraint->add_forces(forces_);
  }
  for (int i = 0; i < system.particles.size(); ++i) {
    if (system.particles.is_fixed(i)) forces_.col(i).setZero();
  }
}

bool StepErrorEstimate::find_correction(ProjectiveSystem& system) {
  ask_constraints(system);
  correction_ = forces_;
  const bool is_one = pieces_.size() <= 2;  // one of them stands for loose particles
  const bool has_few = is_one && !has_clusters_ && !rigid_bend_.is_used();
  return constrained_.find(
      has_few ? kRounds : kManyRounds, mobility_,
      [this](const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left) {
        return solve_with(rows, v, left);
      },
      correction_);
}

bool StepErrorEstimate::solve_with(const PointConstraintRows& rows, Eigen::Matrix3Xd& v,
                                   Forces& left) {
  rows_ = rows;
  hold(rows);
  const bool is_solved = hessian_.solve(kTolerance, v);
  count_work(hessian_.iterations());
  if (is_solved) left = hessian_.residual();
  return is_solved;
}

void StepErrorEstimate::hold(const PointConstraintRows& rows) {
  hessian_.rows().clear();
  append_springs(rows, mobility_, hessian_.rows());
  append_springs(held_rows_, mobility_, hessian_.rows());
  for (const auto& [a, b, along] : rigid_edges_) {
    const double mobility = mobility_[a] + mobility_[b];
    if (!(mobility_[a] > 0.0 && mobility_[b] > 0.0)) continue;
    hessian_.rows().begin_row(kRigid / mobility);
    hessian_.rows().add(a, -along);
    hessian_.rows().add(b, along);
  }
  hessian_.use_rows();
}

void StepErrorEstimate::count_work(int iterations) {
  // A row costs as much as some particles.
  const double particles = std::max<double>(1.0, static_cast<double>(mobility_.size()));
  iterations_ += (1.0 + kRowWork * hessian_.rows().size() / particles) * iterations;
}

double StepErrorEstimate::worst(const ProjectiveSystem& system, const FollowedError& followed,
                                bool have_coasted) {
  const Positions& off = followed.off();
  if (off.cols() != system.particles.x.cols()) return 0.0;
  for (Piece& piece : pieces_) {
    const bool is_free = piece.is_free, has_clusters = piece.has_clusters;
    piece = Piece();
    piece.is_free = is_free;
    piece.has_clusters = has_clusters;
  }
  const Particles& p = system.particles;
  const Positions& first = system.first_positions ? *system.first_positions : p.x_start;
  for (int i = 0; i < p.size(); ++i) {
    if (piece_of_[static_cast<std::size_t>(i)] < 0) continue;
    Piece& piece = pieces_[static_cast<std::size_t>(piece_of_[static_cast<std::size_t>(i)])];
    const double m = p.mass[i];
    Eigen::Vector3d e = off.col(i);
    if (have_coasted) e += coasting_.gone(piece_of_[static_cast<std::size_t>(i)]);
    piece.mass += m;
    piece.center += m * p.x.col(i);
    piece.size += m * p.x.col(i).squaredNorm();
    piece.error += m * e.squaredNorm();
    piece.distance += m * (p.x.col(i) + e - first.col(i)).squaredNorm();
  }
  double error = 0.0;
  worst_piece_ = 0;
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    Piece& piece = pieces_[k];
    if (piece.mass == 0.0) continue;
    const double size = std::max(0.0, piece.size - piece.center.squaredNorm() / piece.mass);
    piece.distance = std::max(piece.distance, kSizeShare * kSizeShare * size);
    const double share = piece.distance > 0.0 ? std::sqrt(piece.error / piece.distance) : 0.0;
    if (share > error || !std::isfinite(share)) {
      error = share;
      worst_piece_ = static_cast<int>(k);
    }
  }
  return std::isfinite(error) ? kCalibration * error : -1.0;
}

bool StepErrorEstimate::is_free(int piece) const {
  const auto k = static_cast<std::size_t>(piece);
  return k < pieces_.size() && pieces_[k].is_free && !held_.is_gripped(piece);
}

bool StepErrorEstimate::has_clusters(int piece) const {
  const auto k = static_cast<std::size_t>(piece);
  return k < pieces_.size() && pieces_[k].has_clusters;
}

double StepErrorEstimate::distance(int piece) const {
  const auto k = static_cast<std::size_t>(piece);
  if (k >= pieces_.size() || !(pieces_[k].mass > 0.0)) return 0.0;
  return std::sqrt(pieces_[k].distance / pieces_[k].mass);
}

bool StepErrorEstimate::find_held(ProjectiveSystem& system) {
  const auto& constraints = system.constraints;
  const bool touches =
      std::any_of(constraints.begin(), constraints.end(),
                  [](const Constraint* constraint) { return constraint->active() > 0; });
  held_.clear();
  if (touches) {
    constrained_.collect_told(system);
    held_.find(constrained_.constraints(), piece_of_, static_cast<int>(pieces_.size()));
  }
  return touches;
}

void StepErrorEstimate::begin_coasting(const ProjectiveSystem& system) {
  coasted_ = 0.0;
  coasting_.begin(static_cast<int>(pieces_.size()), system.particles.mass, followed_.gained(),
                  piece_of_);
}

void StepErrorEstimate::save(StateArchive& numbers) const {
  followed_.save(numbers);
  coasting_.save(numbers);
  numbers.write(coasted_);
}

void StepErrorEstimate::load(StateArchive& numbers) {
  followed_.load(numbers);
  coasting_.load(numbers);
  const double coasted = numbers.read();
  coasted_ = std::isfinite(coasted) ? coasted : 0.0;
}

}  // namespace pliant
