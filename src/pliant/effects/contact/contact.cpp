#include "pliant/effects/contact/contact.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/body.h"
#include "pliant/core/group.h"
#include "pliant/core/step/particle_resident_run.h"
#include "pliant/effects/contact/contact_sweeps.h"

namespace pliant {
namespace {
// Of the offset: how much deeper than that something may be when all have settled.
constexpr double kSettledShare = 0.01;
// Of the offset: what iterations that did not know of a contact may leave to the final projection,
// which inertia alone answers.
constexpr double kLittle = 0.1;
// Of the offset: how little a contact may say that others do not.
constexpr double kRedundant = 1e-3;
// Of a contact's normal: how far it may be from the directions of the faces, since two flats that
// are a little askew touch at their corners, and its least share within these directions where the
// faces are still over what touches.
constexpr double kOver = 0.1, kLeastOver = 0.3;
// Of the distance at which contacts are found: how far beside its point a face may touch. A fast
// one goes on from where it hit.
constexpr double kBeside = 2.0;
// Of the offset: where a step's change of velocity moves a point further in a step, it may have
// been hit; and it was, if its force has become that many times what it was.
constexpr double kImpact = 0.1, kStruck = 10.0;

bool comes_before(const Contact& a, const Contact& b) {
  return a.obstacle != b.obstacle ? a.obstacle < b.obstacle : a.point < b.point;
}

}  // namespace

ContactEffect::ContactEffect(const std::vector<Obstacle>& obstacles, const EmbeddedPoints* embedded,
                             const SurfaceBends* bends, const EmbeddedPoints* surface,
                             double thickness, double margin)
    : obstacles_(obstacles),
      following_(embedded, bends),
      points_(following_.points()),
      detection_(obstacles, 0.5 * thickness, margin + following_.most_rise(), points_),
      surface_depth_(surface),
      redundant_(kRedundant * detection_.offset()),
      pinching_(detection_.offset()) {}

double ContactEffect::project(Contact& contact, const Eigen::VectorXd& mobility,
                              Positions& x) const {
  // x += mobility n Δλ with λ + Δλ >= -adhesion
  const double own = points_.mobility(mobility, contact.point);
  if (own == 0.0) return 0.0;
  const double gap = contact.normal.dot(points_.position(x, contact.point)) - contact.plane;
  const double delta = std::max(-gap / own, -contact.adhesion - contact.normal_force);
  contact.normal_force += delta;
  points_.move(contact.point, delta * contact.normal, mobility, x);
  return std::abs(own * delta);
}

void ContactEffect::begin_step(const Particles& particles, double dt) {
  particles_ = &particles;
  dt_ = dt;
  was_settled_ = false;
  last_.clear();
  if (keeps_multipliers_) last_.swap(contacts_);
  kept_multipliers_ = keeps_multipliers_;
  keeps_multipliers_ = false;
  following_.begin_step(particles, dt);
  find_opening(particles);
  if (following_.follows() && following_.follow(contacts_)) {
    contacts_.clear();
    detection_.find(particles, dt, contacts_);
    following_.leave_out_doubles(contacts_);
  }
  following_.roll(contacts_, particles);
  turn_to_faces(contacts_);
  leave_out_redundant(contacts_);
  wet(0, contacts_);
  found_first_ = contacts_.size();
}

void ContactEffect::find_opening(const Particles& particles) {
  contacts_.clear();
  opening_.begin_step();
  if (!opening_.has_begun()) {
    detection_.allow_depth(0.0);
    detection_.find(particles, dt_, contacts_);
    opening_.begin(detection_.deepest_start(particles, contacts_), dt_);
    if (opening_.left() == 0.0) return;
    contacts_.clear();
  }
  opening_.advance(dt_);
  detection_.allow_depth(opening_.left());
  detection_.find(particles, dt_, contacts_);
}

void ContactEffect::turn_to_faces(std::vector<Contact>& contacts) const {
  if (faced_ == nullptr || contacts.empty()) return;
  const NormalCones& cones = *faced_->normal_cones();
  const Eigen::Matrix3d turn = faced_->turn();
  for (Contact& contact : contacts) {
    if (cones.reach(contact.point) < offset()) continue;
    const Eigen::Vector3d push = turn.transpose() * contact.normal;
    const Eigen::Vector3d part = -cones.part_within(contact.point, -push);
    // Of what touches from another side the faces are no obstacle.
    if (part.norm() < kLeastOver || (part - push).norm() < kOver) continue;
    const Eigen::Vector3d normal = turn * part.normalized();
    const Eigen::Vector3d way = points_.position(particles_->x, contact.point) - contact.touched;
    const double beside = (way - normal * normal.dot(way)).norm();
    if (std::min(cones.reach(contact.point), kBeside * (offset() + margin())) < beside) continue;
    // What is still allowed of its depth stays so.
    const double allowed = contact.normal.dot(contact.touched) + offset() - contact.plane;
    contact.normal = normal;
    contact.plane = normal.dot(contact.touched) + offset() - allowed;
    contact.is_of_face = true;
  }
}

void ContactEffect::leave_out_redundant(std::vector<Contact>& contacts) {
  if (!leaves_out_redundant_) return;
  redundant_.clear();
  for (const Contact& contact : contacts) {
    const Eigen::Vector3d position = points_.position(particles_->x, contact.point);
    redundant_.add({contact.obstacle, contact.normal,
                    contact.is_of_face ? contact.touched : position,
                    contact.normal.dot(position) - contact.plane});
  }
  const std::vector<char>& is_redundant = redundant_.find();
  std::size_t kept = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (!is_redundant[c]) contacts[kept++] = contacts[c];
  }
  contacts.resize(kept);
}

void ContactEffect::find_pinched() {
  pinched_.clear();
  first_normals_.resize(static_cast<std::size_t>(points_.size(*particles_)));
  for (const Contact& contact : contacts_) {
    first_normals_[static_cast<std::size_t>(contact.point)] = contact.normal;
  }
  for (const Contact& contact : contacts_) {
    const auto& other = first_normals_[static_cast<std::size_t>(contact.point)];
    if (contact.normal.dot(other) < 0.0) pinched_.push_back(contact.point);
  }
  std::sort(pinched_.begin(), pinched_.end());
}

bool ContactEffect::is_pinched(const Contact& contact) const {
  return std::binary_search(pinched_.begin(), pinched_.end(), contact.point);
}

void ContactEffect::warm_start() {
  keeps_multipliers_ = true;
  find_pinched();
  if (last_.empty()) return;
  // Those that were found late stand at the end.
  std::sort(last_.begin(), last_.end(), comes_before);
  std::size_t next = 0;
  for (Contact& contact : contacts_) {
    while (next < last_.size() && comes_before(last_[next], contact)) ++next;
    double begun = 0.0;
    for (std::size_t k = next; k < last_.size() && !comes_before(contact, last_[k]); ++k) {
      const Contact& last = last_[k];
      contact.normal_force += last.normal_force;
      contact.friction_force += last.friction_force;
      begun += last.begun;
    }
    // The force of an impact is none that goes on, but that of a hand that accelerates is: without
    // it friction would have to find anew what it holds, and may find that it lets go. What presses
    // a point from both sides has no place for either: forces would grow from step to step.
    const Eigen::Vector3d change = points_.position(particles_->v_start, contact.point) -
                                   points_.position(particles_->v_before, contact.point);
    const bool is_hit =
        dt_ * change.norm() > kImpact * offset() && contact.normal_force > kStruck * begun;
    if (is_pinched(contact) || is_hit) {
      contact.normal_force = 0.0;
      contact.friction_force.setZero();
    }
    contact.normal_force = std::max(contact.normal_force, -contact.adhesion);
    contact.friction_force -= contact.normal * contact.normal.dot(contact.friction_force);
    contact.begun = contact.normal_force;
  }
}

void ContactEffect::add_point_constraints(const Positions& x, PointConstraints& constraints) {
  first_constraint_ = constraints.all.size();
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Contact& contact = contacts_[c];
    PointConstraint& constraint = constraints.append();
    constraint.normal = contact.normal;
    constraint.gap = contact.normal.dot(points_.position(x, contact.point)) - contact.plane;
    constraint.is_contradicted = is_pinched(contact);
    constraint.is_rigid = leaves_out_redundant_;
    constraint.is_late = c >= found_first_;
    constraint.lowest = -contact.adhesion;
    constraint.normal_force = contact.normal_force;
    constraint.friction_force = contact.friction_force;
    points_.add_entries(contact.point, constraints);
  }
}

void ContactEffect::take_multipliers(const PointConstraints& constraints) {
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const PointConstraint& constraint = constraints.all[first_constraint_ + c];
    contacts_[c].normal_force = constraint.normal_force;
    contacts_[c].friction_force = constraint.friction_force;
  }
}

void ContactEffect::undo_step() {
  contacts_ = last_;
  keeps_multipliers_ = kept_multipliers_;
  opening_.undo_step();
  following_.undo_step();
  pinching_.undo();
}

void ContactEffect::save(StateArchive& numbers) const {
  numbers.write(opening_.state());
  following_.save(numbers);
  numbers.write(keeps_multipliers_ ? static_cast<double>(contacts_.size()) : 0.0);
  if (!keeps_multipliers_) return;
  for (const Contact& contact : contacts_) {
    numbers.write(contact.point);
    numbers.write(contact.obstacle);
    numbers.write(contact.normal_force);
    numbers.write_all(contact.friction_force);
    numbers.write(contact.begun);
  }
}

void ContactEffect::load(StateArchive& numbers) {
  opening_.set_state(numbers.read());
  following_.load(numbers);
  constexpr std::size_t kNumbersOfEach = 7;
  const std::size_t count = numbers.read_count(kNumbersOfEach);
  keeps_multipliers_ = count > 0;
  contacts_.resize(count);
  for (Contact& contact : contacts_) {
    contact = {};
    contact.point = numbers.read_int();
    contact.obstacle = numbers.read_index(static_cast<std::int64_t>(obstacles_.size()));
    contact.normal_force = numbers.read();
    numbers.read_all(contact.friction_force);
    contact.begun = numbers.read();
  }
}

void ContactEffect::wet(std::size_t first, std::vector<Contact>& contacts) const {
  if (wet_ == nullptr) return;
  for (std::size_t c = first; c < contacts.size(); ++c) {
    Contact& contact = contacts[c];
    contact.friction_factor = wet_->friction_factor[contact.point];
    const double gap =
        contact.normal.dot(particles_->x_start.col(contact.point) + contact.surface_motion) -
        contact.plane;
    contact.adhesion = gap <= wet_->range ? wet_->adhesion[contact.point] : 0.0;
  }
}

void ContactEffect::reset_multipliers() {
  for (Contact& contact : contacts_) {
    contact.guess = contact.normal_force;
    contact.friction_guess = contact.friction_force;
    contact.normal_force = 0.0;
    contact.friction_force.setZero();
  }
}

void ContactEffect::relax(const Eigen::VectorXd& mobility, Positions& x) {
  if (!points_.are_embedded()) {
    for (Contact& contact : contacts_) project(contact, mobility, x);
    return;
  }
  for (Contact& contact : contacts_) {
    contact.normal_force += contact.guess;
    points_.move(contact.point, contact.guess * contact.normal, mobility, x);
    contact.guess = 0.0;
  }
  sweep(mobility, x);
}

void ContactEffect::sweep(const Eigen::VectorXd& mobility, Positions& x) {
  sweep_to_rest(offset(), kMaxSweeps, [&] {
    double largest = 0.0;
    for (Contact& contact : contacts_) largest = std::max(largest, project(contact, mobility, x));
    return largest;
  });
}

void ContactEffect::add_forces(Forces& f) const {
  for (const Contact& contact : contacts_) {
    points_.add_force(contact.point, contact.normal_force * contact.normal + contact.friction_force,
                      f);
  }
}

void ContactEffect::add_rows(const Positions& x, ConstraintRows& rows) {
  for (Contact& contact : contacts_) {
    contact.corrections = contact.is_held() ? contact.corrections + 1 : 0;
    if (contact.corrections == 0) continue;
    // A particle is where its own contact put it; points that share particles may be off a little.
    const double gap = contact.normal.dot(points_.position(x, contact.point)) - contact.plane;
    rows.begin_row(points_.are_embedded() && std::abs(gap) > kContactRest * offset() ? -gap : 0.0,
                   0.0);
    points_.add_to_row(contact.point, contact.normal, rows);
  }
}

int ContactEffect::active() const {
  const auto loaded = [](const Contact& contact) { return contact.normal_force != 0.0; };
  return static_cast<int>(std::count_if(contacts_.begin(), contacts_.end(), loaded));
}

void ContactEffect::close(const Eigen::VectorXd& mobility, Positions& x) {
  for (Contact& contact : contacts_) {
    const double before = contact.normal_force;
    project(contact, mobility, x);
    contact.normal_force =
        before + momentum_share(contact, mobility) * (contact.normal_force - before);
  }
}

double ContactEffect::momentum_share(const Contact& contact,
                                     const Eigen::VectorXd& mobility) const {
  return points_.moved_mass(mobility, particles_->mass, contact.point) / (dt_ * dt_);
}

void ContactEffect::find_late() {
  late_.clear();
  detection_.find_again(*particles_, dt_, late_);
  following_.roll(late_, *particles_, particles_->x);
  turn_to_faces(late_);
  leave_out_redundant(late_);
}

bool ContactEffect::touches_another(const Positions& x, bool answers_each) const {
  return std::any_of(late_.begin(), late_.end(), [&](const Contact& contact) {
    const double gap = contact.normal.dot(points_.position(x, contact.point)) - contact.plane;
    if (gap >= -kLittle * offset()) return false;
    return std::none_of(contacts_.begin(), contacts_.end(), [&](const Contact& known) {
      if (known.obstacle != contact.obstacle) return false;
      return answers_each ? known.point == contact.point : known.is_held();
    });
  });
}

bool ContactEffect::finds_more(const Positions& x, bool done) {
  // What the final projection does to a few vertices of a stiff cloth is no part of a converged
  // step.
  const bool answers_each = done && keeps_multipliers_ && !points_.are_embedded();
  if (!looks_again_ && !answers_each) return false;
  find_late();
  if (!touches_another(x, answers_each)) return false;
  const std::size_t first = contacts_.size();
  for (const Contact& contact : late_) {
    const auto is_it = [&contact](const Contact& known) {
      return known.obstacle == contact.obstacle && known.point == contact.point;
    };
    const auto end = contacts_.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::none_of(contacts_.begin(), end, is_it)) contacts_.push_back(contact);
  }
  wet(first, contacts_);
  if (keeps_multipliers_) find_pinched();
  return true;
}

void ContactEffect::final_projection(const Eigen::VectorXd& mobility, Positions& x) {
  if (keeps_multipliers_ && !points_.are_embedded()) close(mobility, x);
  find_late();
  if (!points_.are_embedded()) {
    for (Contact& contact : late_) {
      project(contact, mobility, x);
      if (!(contact.normal_force > 0.0)) continue;
      // No iteration answers this move any more: what it changes is momentum alone, m Δx/h².
      contact.normal_force *= momentum_share(contact, mobility);
      contacts_.push_back(contact);
    }
    return;
  }
  contacts_.insert(contacts_.end(), late_.begin(), late_.end());
  for (Contact& contact : contacts_) contact.guess = contact.normal_force;
  sweep(mobility, x);
  for (Contact& contact : contacts_) {
    const double change = contact.normal_force - contact.guess;
    contact.normal_force = contact.guess + momentum_share(contact, mobility) * change;
  }
}

bool ContactEffect::limit_displacement(Positions& x) {
  if (!was_settled_) return true;
  was_settled_ = false;
  late_.clear();
  detection_.find_again(*particles_, dt_, late_);
  bool any = false;
  for (const Contact& contact : late_) {
    const double gap = contact.normal.dot(points_.position(x, contact.point)) - contact.plane;
    if (gap >= -kSettledShare * offset()) continue;
    any = true;
    contacts_.push_back(contact);
  }
  return !any;
}

double ContactEffect::alternating_projection(const Eigen::VectorXd& mobility, Positions& x) {
  was_settled_ = true;
  double deepest = 0.0;
  for (const Contact& contact : contacts_) {
    const double own = points_.mobility(mobility, contact.point);
    const double gap = contact.normal.dot(points_.position(x, contact.point)) - contact.plane;
    if (own == 0.0 || gap >= 0.0) continue;
    deepest = std::max(deepest, -gap);
    points_.move(contact.point, -gap / own * contact.normal, mobility, x);
  }
  return deepest / (kSettledShare * offset());
}

void ContactEffect::report(StepReport& report) const {
  report.contacts += active();
  if (!pinching_.text().empty()) return report.warn(pinching_.text());
  if (particles_ != nullptr) surface_depth_.look(*particles_, obstacles_, contacts_, report);
}

void ContactEffect::add_reactions(std::vector<Reaction>& reactions) const {
  for (const Contact& contact : contacts_) {
    const auto o = static_cast<std::size_t>(contact.obstacle);
    const Eigen::Vector3d force = -(contact.normal_force * contact.normal + contact.friction_force);
    const Eigen::Vector3d at = points_.position(particles_->x, contact.point);
    reactions[o].force += force;
    reactions[o].torque += (at - obstacles_[o].pose_end.translation()).cross(force);
    const double depth = contact.plane - contact.normal.dot(at);
    if (depth > reactions[o].overlap.depth) {
      reactions[o].overlap = {depth, offset(), at, contact.normal};
    }
  }
}

void ContactEffect::after_step(Body&, double dt) {
  // A GPU may have taken the step, and asked nothing here.
  if (particles_ == nullptr) return;
  pinching_.look(points_, particles_->x, contacts_, obstacles_);
  following_.end_step(particles_->x, dt);
}

void ContactEffect::reset(Body&) {
  pinching_.reset();
  contacts_.clear();
  last_.clear();
  keeps_multipliers_ = false;
  opening_.reset();
  following_.reset();
}

bool ContactEffect::join_resident_run(ResidentRun& run) const {
  // A resident run knows nothing of bodies that begin too deep.
  if (!opening_.has_begun() || opening_.left() > 0.0) return false;
  if (run.particles) {
    run.particles->meets_walls = run.particles->flows && !obstacles_.empty();
  }
  return true;
}

EffectRegistry::Entry contact_entry() {
  return {"contact",
          "keeps bodies out of obstacles and robot links, continuously in time, without bounce",
          {positive_parameter("thickness", "m", "0.002", 1.0,
                              "twice the distance that points keep from surfaces"),
           number_parameter("margin", "m", "0.0005", 0.0, 1.0,
                            "contacts open by less than this take part in the iterations")},
          {"cloth", "patch", "reduced", "viscoelastic", "rigid"},
          [](const Parameters& parameters, const EffectSite& site) {
            const Model& model = *site.body.model;
            auto contact = std::make_unique<ContactEffect>(
                site.obstacles, model.contact_points(), model.surface_bends(),
                model.surface_points(), parameters.number("thickness"),
                parameters.number("margin"));
            if (model.is_solid() || site.body.group->joint() != nullptr) contact->look_again();
            if (model.is_rigid()) contact->leave_out_redundant();
            if (model.normal_cones() != nullptr) contact->face_with(model);
            return contact;
          }};
}

}  // namespace pliant
