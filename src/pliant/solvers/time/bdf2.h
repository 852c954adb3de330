#pragma once

#include "pliant/core/step/time_integration.h"

namespace pliant {

/// The backward differentiation formula of second order, with steps whose ratio w = h/h_before may
/// change (Hairer and Wanner 1996, III.5): of velocities and positions alike
///   y' = [y - y_n - c (y_n - y_before)] / h*,  c = w²/(1 + 2w),  h* = h (1 + w)/(1 + 2w).
/// Stable at any step, and damps what a step does not resolve. What effects change of velocities
/// between steps is none of y_n - y_before: its whole was given already.
class Bdf2 final : public TimeIntegration {
 public:
  std::string_view name() const override { return "bdf2"; }
  double begin_step(Particles& p, double dt) const override;
};

TimeIntegrationRegistry::Entry bdf2_entry();

}  // namespace pliant
