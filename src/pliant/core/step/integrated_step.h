#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "pliant/core/state_archive.h"
#include "pliant/core/step/step_report.h"
#include "pliant/core/step/time_integration.h"
#include "pliant/core/system/system.h"

namespace pliant {

struct Body;
class Group;
class Solver;

/// Steps of a group's bodies by an integration of second order. Each is taken by implicit Euler
/// where that integration cannot take it: after an impact, since velocities that jump have no
/// continuation; where it gains energy; where it does not know the step before. The report says so.
class IntegratedStep {
 public:
  IntegratedStep(Group& group, std::shared_ptr<const TimeIntegration> integration);

  const TimeIntegration& integration() const { return *integration_; }
  /// Whether the last step was of first order for the sake of an impact.
  bool has_hit() const;
  /// Throws InputError where one of the group's solvers has an integration of its own.
  void check(const std::vector<Solver*>& solvers) const;
  /// As Solver::prepare(), for steps of `dt` [s].
  void prepare(double dt);
  /// The next step is the first one.
  void reset() { dt_ = effective_ = 0.0; }
  /// The step that the solver is prepared for, and another one [s].
  double effective_step() const { return effective_; }
  void prepare_effective(double step);

  void begin(double dt);
  void finish();
  /// Of a body that its step took, before effects change its velocities.
  void remember(Body& body) const;

 private:
  Particles& particles() const;
  void open_histories();
  std::string_view why_not() const;
  bool begin_second_order();
  /// By what takes steps in contact, or at first order where it cannot.
  void begin_in_contact();
  bool is_led() const;
  void begin_first_order();
  void begin_solver(double effective);
  /// Back to the step's beginning, for another try.
  void retract();
  void take_again(StepReport& report);
  std::string_view why_fall_back();
  bool touches() const;
  bool all_are_idle() const;
  /// Whether what touches changed its velocity at once.
  bool has_impact();
  bool gains_energy();
  void warn_of_ignored(StepReport& report) const;

  Group& group_;
  std::shared_ptr<const TimeIntegration> integration_;
  const TimeIntegration* own_ = nullptr;  // of the running step: that, or what it has for contact
  double dt_ = 0.0;                       // of the running step [s]
  double effective_ = 0.0;                // that the solver is prepared for [s]
  std::string_view first_order_;          // why this step is; empty: it is not
  StateArchive learned_;                  // by the solver, when the step began
  Forces forces_;                         // of what touches [N]
};

}  // namespace pliant
