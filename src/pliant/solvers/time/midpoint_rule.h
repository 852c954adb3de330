#pragma once

#include "pliant/solvers/time/bdf2.h"

namespace pliant {

/// The implicit midpoint rule: half a step of implicit Euler, and as far again. Of second order;
/// keeps momentum and angular momentum exactly and energy on the whole, and damps nothing: what a
/// step does not resolve rings on. Constraints would hold at the middle of a step alone, so that
/// steps in which any may act are taken by BDF2, whose order is the same.
class MidpointRule final : public TimeIntegration {
 public:
  std::string_view name() const override { return "midpoint"; }
  double begin_step(Particles& /*p*/, double dt) const override { return 0.5 * dt; }
  bool ends_with_solver() const override { return false; }
  void end_step(Particles& p) const override;
  const TimeIntegration* in_contact() const override { return &bdf2_; }

 private:
  Bdf2 bdf2_;
};

TimeIntegrationRegistry::Entry midpoint_rule_entry();

}  // namespace pliant
