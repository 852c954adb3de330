#pragma once

#include <optional>

#include "pliant/core/effect.h"
#include "pliant/effects/contact_detection.h"

namespace pliant {

/// Keeps particles out of obstacles: non-penetration without bounce, by projection onto the
/// tangent planes found in each step.
class ContactEffect final : public Effect, public Coupling {
 public:
  ContactEffect(const std::vector<Obstacle>& obstacles, double thickness, double margin);
  std::string_view name() const override { return "contact"; }

  Coupling* coupling() override { return this; }
  void add_reactions(std::vector<Reaction>& reactions) const override;
  void reset(Body& body) override;

  void begin_step(const Particles& particles, double dt) override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& mobility, Positions& x) override;
  void add_forces(Forces& f) const override;
  void add_rows(const Positions& x, CouplingRows& rows) override;
  int active() const override;
  /// Finds what the iterations moved into obstacles and moves it back out.
  void finish(const Eigen::VectorXd& mobility, Positions& x) override;
  void report(StepReport& report) const override;

  std::vector<Contact>& contacts() { return contacts_; }
  const std::vector<Contact>& contacts() const { return contacts_; }
  /// Distance that particles keep from surfaces: half the thickness [m].
  double offset() const { return detection_.offset(); }

 private:
  const std::vector<Obstacle>& obstacles_;
  ContactDetection detection_;
  const Particles* particles_ = nullptr;  // of the running step
  double dt_ = 0.0;
  std::vector<Contact> contacts_;
  std::vector<Contact> late_;
};

EffectRegistry::Entry contact_entry();

}  // namespace pliant
