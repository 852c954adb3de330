#pragma once

#include "pliant/effects/contact/contact.h"
#include "pliant/effects/contact/restored_shape.h"

namespace pliant {

/// Coulomb friction at the contacts of the `contact` effect; one coefficient, static and dynamic.
class FrictionEffect final : public Effect, public Constraint {
 public:
  FrictionEffect(ContactEffect& contact, const std::vector<Obstacle>& obstacles,
                 double coefficient);
  std::string_view name() const override { return "friction"; }
  Constraint* constraint() override { return this; }
  bool join_resident_run(ResidentRun&) const override { return true; }  // as the contact effect's

  /// Coulomb's, of a contact.
  double coefficient(const Contact& contact) const;

  /// What friction took of the motion of each particle in the step that led to `x`, the work of its
  /// forces over what slid: half of it where the obstacle has a temperature, whose the other half
  /// is, else all of it [J]. Of points that are particles.
  Eigen::VectorXd losses(const Positions& x) const;

  void after_step(Body& body, double dt) override;
  void undo_step() override;
  void reset(Body& body) override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

  void begin_step(const Particles& particles, double dt) override;
  void final_projection(const Eigen::VectorXd& mobility, Positions& x) override;
  bool is_idle() const override { return contact_.is_idle(); }
  void reset_multipliers() override {}  // the contact effect resets both forces
  void relax(const Eigen::VectorXd& mobility, Positions& x) override;
  void add_forces(Forces&) const override {}  // the contact effect adds both forces
  void add_rows(const Positions& x, ConstraintRows& rows) override;
  bool takes_multipliers() const override { return true; }
  void add_point_constraints(const Positions& x, PointConstraints& constraints) override;

 protected:
  void* offer(const std::type_info& type) override { return offer_as<FrictionEffect>(this, type); }

 private:
  double bound(const Contact& contact) const;  // of the friction force [N]
  /// Whether a correction of all particles at once has to hold it where it is after `displacement`.
  bool sticks(const Contact& contact, const Eigen::Vector3d& displacement) const;
  /// Slows the slip of one contact; returns how far that moved its point [m].
  double relax(Contact& contact, const Eigen::VectorXd& mobility, Positions& x) const;
  /// Displacement of the point over the surface since the step began [m].
  Eigen::Vector3d slip(const Contact& contact, const Positions& x) const;

  ContactEffect& contact_;
  const std::vector<Obstacle>& obstacles_;
  double coefficient_;
  const Particles* particles_ = nullptr;
  RestoredShape restored_;
};

EffectRegistry::Entry friction_entry();

}  // namespace pliant
