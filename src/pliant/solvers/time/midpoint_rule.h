#pragma once

#include "pliant/core/step/time_integration.h"

namespace pliant {

/// The implicit midpoint rule: half a step of implicit Euler, and as far again. Of second order;
/// keeps momentum and angular momentum exactly and energy on the whole, and damps nothing: what a
/// step does not resolve rings on. Constraints hold at the middle of a step alone, so that steps in
/// which any may act are taken by implicit Euler.
class MidpointRule final : public TimeIntegration {
 public:
  std::string_view name() const override { return "midpoint"; }
  double begin_step(Particles& /*p*/, double dt) const override { return 0.5 * dt; }
  bool ends_with_solver() const override { return false; }
  void end_step(Particles& p) const override;
};

TimeIntegrationRegistry::Entry midpoint_rule_entry();

}  // namespace pliant
