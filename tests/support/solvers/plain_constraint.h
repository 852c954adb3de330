#pragma once

#include "pliant/core/system/constraint.h"

namespace pliant {

/// A constraint that holds nothing: what a test looks at, it overrides.
class PlainConstraint : public Constraint {
 public:
  std::string_view name() const override { return "plain"; }
  void begin_step(const Particles&, double) override {}
  void reset_multipliers() override {}
  void relax(const Eigen::VectorXd&, Positions&) override {}
  void add_forces(Forces&) const override {}
  void add_rows(const Positions&, ConstraintRows&) override {}
};

/// One that tells where it holds, as contact does.
class TellingConstraint : public PlainConstraint {
 public:
  bool takes_multipliers() const override { return true; }
};

}  // namespace pliant
