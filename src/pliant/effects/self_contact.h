#pragma once

#include "pliant/core/effect.h"
#include "pliant/effects/self_contact_detection.h"

namespace pliant {

/// Keeps the parts of a body out of each other and each part out of itself, with friction: forces
/// in pairs, equal and opposite.
class SelfContactEffect final : public Effect, public Coupling {
 public:
  using Options = SelfContactDetection::Options;

  SelfContactEffect(SelfContactParts parts, const Options& options);
  std::string_view name() const override { return "self_contact"; }
  Coupling* coupling() override { return this; }
  void reset(Body& body) override;

  void begin_step(const Particles& particles, double dt) override;
  void reset_multipliers() override { pairs_.reset_multipliers(); }
  void relax(const Eigen::VectorXd& mobility, Positions& x) override { pairs_.relax(mobility, x); }
  void add_forces(Forces& f) const override { pairs_.add_forces(f); }
  void add_rows(const Positions& x, CouplingRows& rows) override { pairs_.add_rows(x, rows); }
  int active() const override { return pairs_.active(); }
  void report(StepReport& report) const override;

  const std::vector<PairContact>& contacts() const { return pairs_.all(); }

 private:
  SelfContactDetection detection_;
  PairContacts pairs_;
};

EffectRegistry::Entry self_contact_entry();

}  // namespace pliant
