#include "pliant/models/reduced/reduced_body_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/core/system/find_constraint.h"
#include "pliant/math/dense_factors.h"

namespace pliant {
namespace {

// Of the largest response of a coordinate.
constexpr double kLeastResponse = 1e-12;

}  // namespace

ReducedBodySystem::ReducedBodySystem(const ReducedModel& model, const RayleighDamping& rayleigh,
                                     double fast, EmbeddedPoints touching)
    : ReducedSystem(model.potential, rayleigh),
      vertices_(model),
      touching_(std::move(touching)),
      attachments_(vertices_),
      contact_(vertices_, touching_),
      stretches_(model.mesh),
      fast_(fast),
      q_start_(q),
      p_start_(p) {
  guess_ = guess_start_ = from_others_ = Eigen::VectorXd::Zero(q.size());
  particles = Particles(model.mesh.vertices, model.material.density * vertex_volumes(model.mesh));
  for (int i = 0; i < particles.size(); ++i) {
    if (model.fixed[static_cast<std::size_t>(i)]) particles.fix(i);
  }
}

void ReducedBodySystem::place(const Eigen::Isometry3d& world_from_body) {
  vertices_.place(world_from_body);
  move_particles();
}

void ReducedBodySystem::move_particles() {
  vertices_.positions(q, particles.x);
  vertices_.velocities(p, particles.v);
  particles.x_start = particles.x;
  particles.v_start = particles.v;
}

int ReducedBodySystem::first_fast(double h) const {
  const double slow =
      fast_ > 0.0 ? 2.0 * static_cast<double>(EIGEN_PI) * fast_ : 1.0 / h;  // [rad/s]
  int first = 0;
  while (first < q.size() && potential.lambda()[first] < slow * slow) ++first;
  return first;
}

void ReducedBodySystem::add_attachments(std::unique_ptr<AttachmentSet> set) {
  attachments_.add(std::move(set));
}

double ReducedBodySystem::elastic_energy() const {
  return ReducedSystem::elastic_energy() + attachments_.energy(particles.x);
}

void ReducedBodySystem::take_response(const StepResponse& response) {
  response_.emplace(response);
  knows_inverse_ = false;
}

void ReducedBodySystem::begin_step(double) {
  q_start_ = q;
  p_start_ = p;
  guess_start_ = guess_;
  particles.x_start = particles.x;
  particles.v_before.swap(particles.v_start);
  particles.v_start = particles.v;
  attachments_.begin_step();
  contact_.begin_step();
  vertices_.reduce(external_forces, force);
  force += attachments_.guess() + contact_.guess();
  if (stays_open_) force += guess_;
  balance_.begin(*this);
}

ReducedContact::Step ReducedBodySystem::contact_step(ContactEffect& effect) const {
  return {h_, *response_, q_start_, effect, find_constraint<FrictionEffect>(constraints)};
}

void ReducedBodySystem::end_step(double h, const StepResponse& response, StepReport& report) {
  h_ = h;
  report_ = &report;
  tell_taken(balance_.end(*this));
  attachments_.hold(h, response, q_start_, q, p);
  response_.emplace(attachments_.response(response));
  knows_inverse_ = false;
  if (stays_open_) {
    response_->to_q(guess_, moved_);
    q -= moved_;
    response_->to_p(guess_, moved_);
    p -= moved_;
    from_others_.setZero(vertices_.rank());
  }
  touched_ = find_constraint<ContactEffect>(constraints);
  if (touched_ != nullptr) {
    ScopedPhase phase(report, "reduced_contact");
    contact_.begin(contact_step(*touched_), *this);
    contact_.hold(contact_step(*touched_), *this);
  }
  if (!stays_open_) close(1.0, h);
}

void ReducedBodySystem::move(const Forces& f, Positions& x) {
  vertices_.reduce(f, reduced_);
  response_->to_q(reduced_ - from_others_, moved_);
  from_others_ = reduced_;
  if (touched_ != nullptr) {
    ScopedPhase phase(*report_, "reduced_contact");
    contact_.shift(moved_);
    contact_.hold(contact_step(*touched_), *this);
  } else {
    q += moved_;
    vertices_.positions(q, particles.x);
  }
  x = particles.x;
}

void ReducedBodySystem::respond(const std::vector<int>& at, Eigen::Ref<Forces> v) {
  reduced_.setZero(vertices_.rank());
  for (const int i : at) reduced_ += vertices_.rows(i).lazyProduct(v.col(i));
  response_->to_q(reduced_, moved_);
  for (const int i : at) v.col(i) = vertices_.rows(i).transpose().lazyProduct(moved_);
}

double ReducedBodySystem::answer(int particle) {
  const auto rows = vertices_.rows(particle);
  double most = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    reduced_ = rows.col(axis);
    response_->to_q(reduced_, moved_);
    most = std::max(most, reduced_.dot(moved_));
  }
  return most;
}

const Eigen::MatrixXd& ReducedBodySystem::inverse_response() {
  if (knows_inverse_) return inverse_response_;
  knows_inverse_ = true;
  const Eigen::Index rank = vertices_.rank();
  Eigen::MatrixXd response(rank, rank);
  response_->to_q(Eigen::MatrixXd::Identity(rank, rank), response);
  response = (0.5 * (response + response.transpose())).eval();
  // A coordinate that nothing moves gets some room.
  response.diagonal().array() += kLeastResponse * response.diagonal().maxCoeff();
  inverse_response_ =
      DenseLdlt(response).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(rank, rank)));
  return inverse_response_;
}

void ReducedBodySystem::close(double share, double dt) {
  if (stays_open_) {
    response_->to_p(from_others_, moved_);
    p += moved_;
  }
  if (touched_ != nullptr) {
    ScopedPhase phase(*report_, "reduced_contact");
    contact_.end(contact_step(*touched_), *this);
  }
  if (share < 1.0) {
    // Held back, it is where it went, and as fast.
    q = q_start_ + share * (q - q_start_);
    p = (q - q_start_) / dt;
  }
  if (balance_.has_to_compare(*this)) {
    // The forces that moved it from there: those of contact, attachments and other bodies.
    reduced_ = inverse_response() * (q - balance_.q_end());
    tell_taken(balance_.close(*this, reduced_));
  }
  guess_ = from_others_;
  finish_step();
}

void ReducedBodySystem::tell_taken(double energy) {
  if (!(energy > 0.0)) return;
  report_->add_metric("energy_taken", energy);
  report_->warn(
      "energy_held: the step is too long for this motion, or the material collapsed; what it would "
      "have added to the energy was taken back: take a smaller time step");
}

void ReducedBodySystem::finish_step() {
  if (touched_ != nullptr) touched_->report(*report_);
  attachments_.finish(q_start_, q);
  ScopedPhase phase(*report_, "vertices");
  if (touched_ == nullptr || stays_open_) vertices_.positions(q, particles.x);
  vertices_.velocities(p, particles.v);
  report_->add_metric("high_frequency_energy", linear_energy(first_fast(h_)));
  if (stretches_.look(particles.x) < kSofteningStretch) {
    report_->warn(
        "stvk_compression: tetrahedra are compressed below 0.577 of their rest length, where the "
        "material softens and may collapse");
  }
}

void ReducedBodySystem::add_rows(int particle, double weight,
                                 Eigen::Ref<Eigen::MatrixXd> rows) const {
  rows += weight * vertices_.rows(particle);
}

void ReducedBodySystem::take_impulses(const Eigen::VectorXd& impulses, double dt) {
  guess_ += impulses / dt;
  if (touched_ != nullptr) contact_.stop(contact_step(*touched_), *this);
  vertices_.velocities(p, particles.v);
}

void ReducedBodySystem::scale_velocities(double factor) {
  p *= factor;
  System::scale_velocities(factor);
}

void ReducedBodySystem::undo_step() {
  System::undo_step();
  q.swap(q_start_);
  p.swap(p_start_);
  attachments_.undo_step();
  contact_.undo_step();
  balance_.undo_step();
  guess_.swap(guess_start_);
}

void ReducedBodySystem::reset() {
  attachments_.reset();
  contact_.reset();
  stretches_.reset();
  balance_.reset();
  guess_.setZero();
}

void ReducedBodySystem::save(StateArchive& numbers) const {
  numbers.write_all(q);
  numbers.write_all(p);
  attachments_.save(numbers);
  contact_.save(numbers);
  balance_.save(numbers);
  numbers.write_all(guess_);
}

void ReducedBodySystem::load(StateArchive& numbers) {
  numbers.read_all(q);
  numbers.read_all(p);
  attachments_.load(numbers);
  contact_.load(numbers);
  balance_.load(numbers);
  numbers.read_all(guess_);
  stretches_.reset();
}

}  // namespace pliant
