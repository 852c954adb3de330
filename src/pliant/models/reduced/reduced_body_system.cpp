#include "pliant/models/reduced/reduced_body_system.h"

#include <cmath>
#include <utility>

namespace pliant {
namespace {

template <class Wanted>
Wanted* find(const std::vector<Coupling*>& couplings) {
  for (Coupling* coupling : couplings) {
    if (auto* found = dynamic_cast<Wanted*>(coupling)) return found;
  }
  return nullptr;
}

}  // namespace

ReducedBodySystem::ReducedBodySystem(const ReducedModel& model, const RayleighDamping& rayleigh,
                                     double fast, CarriedPoints touching)
    : ReducedSystem(model.potential, rayleigh),
      vertices_(model),
      touching_(std::move(touching)),
      attachments_(vertices_),
      contact_(vertices_, touching_),
      stretches_(model.mesh),
      fast_(fast),
      q_start_(q),
      p_start_(p) {
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

void ReducedBodySystem::begin_step(double) {
  q_start_ = q;
  p_start_ = p;
  particles.x_start = particles.x;
  particles.v_before.swap(particles.v_start);
  particles.v_start = particles.v;
  attachments_.begin_step();
  contact_.begin_step();
  vertices_.reduce(external_forces, force);
  force += attachments_.guess() + contact_.guess();
}

void ReducedBodySystem::end_step(double h, const StepResponse& response, StepReport& report) {
  attachments_.hold(h, response, q_start_, q, p);
  auto* contact = find<ContactEffect>(couplings);
  if (contact != nullptr) {
    ScopedPhase phase(report, "reduced_contact");
    const ReducedResponse held = attachments_.response(response);
    contact_.solve(*contact, find<FrictionEffect>(couplings), {h, held, q_start_}, *this);
    contact->report(report);
  }
  attachments_.finish(q_start_, q);
  ScopedPhase phase(report, "vertices");
  if (contact == nullptr) vertices_.positions(q, particles.x);
  vertices_.velocities(p, particles.v);
  report.add_figure("high_frequency_energy", linear_energy(first_fast(h)));
  if (stretches_.look(particles.x) < kSofteningStretch) {
    report.warn(
        "stvk_compression: tetrahedra are compressed below 0.577 of their rest length, where the "
        "material softens and may collapse");
  }
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
}

void ReducedBodySystem::reset() {
  attachments_.reset();
  contact_.reset();
  stretches_.reset();
}

void ReducedBodySystem::save(SavedNumbers& numbers) const {
  numbers.write_all(q);
  numbers.write_all(p);
  attachments_.save(numbers);
  contact_.save(numbers);
}

void ReducedBodySystem::load(SavedNumbers& numbers) {
  numbers.read_all(q);
  numbers.read_all(p);
  attachments_.load(numbers);
  contact_.load(numbers);
  stretches_.reset();
}

}  // namespace pliant
