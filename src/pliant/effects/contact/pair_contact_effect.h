#pragma once

#include <memory>
#include <vector>

#include "pliant/core/effect.h"
#include "pliant/effects/contact/pair_detection.h"
#include "pliant/effects/contact/pair_forces.h"

namespace pliant {

/// Keeps surfaces out of each other, with friction: forces in pairs, equal and opposite, at what a
/// detection finds.
class PairContactEffect : public Effect, public Constraint {
 public:
  void reset(Body& body) override;

  void begin_step(const Particles& particles, double dt) override;
  /// Solvers that find the forces together with displacements begin with those of the last step.
  void warm_start() override;
  void after_step(Body& body, double dt) override;
  void undo_step() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;
  void reset_multipliers() override { pairs_.reset_multipliers(); }
  void relax(const Eigen::VectorXd& mobility, Positions& x) override { pairs_.relax(mobility, x); }
  void add_forces(Forces& f) const override { pairs_.add_forces(f); }
  void add_rows(const Positions& x, ConstraintRows& rows) override { pairs_.add_rows(x, rows); }
  /// What is a sheet has a last look of its own, and settles what it finds then.
  bool takes_multipliers() const override { return true; }
  bool tells_point_constraints() const override { return true; }
  void add_point_constraints(const Positions& x, PointConstraints& constraints) override;
  void take_multipliers(const PointConstraints& constraints) override;
  bool is_idle() const override { return pairs_.all().empty(); }
  int active() const override { return pairs_.active(); }
  bool finds_more(const Positions& x, bool done) override;
  void final_projection(const Eigen::VectorXd& mobility, Positions& x) override;
  double alternating_projection(const Eigen::VectorXd& mobility, Positions& x) override;
  bool limit_displacement(Positions& x) override;
  void report(StepReport& report) const override;

  PairDetection& detection() { return *detection_; }
  /// That carry a contact, at the most.
  int most_particles() const { return detection_->most_particles(); }
  const std::vector<PairContact>& contacts() const { return pairs_.all(); }
  std::size_t most_contacts() const { return detection_->most_contacts(); }
  /// Whether there are more contacts than that, so that some are missing from the list.
  bool is_crowded() const;
  std::vector<PairContact>& contacts() { return pairs_.all(); }

 protected:
  void* offer(const std::type_info& type) override {
    return offer_as<PairContactEffect>(this, type);
  }
  PairContactEffect(std::unique_ptr<PairDetection> detection, double thickness);
  /// Whether pairs are of different bodies, whose momenta are told apart.
  virtual bool is_between_bodies() const { return false; }
  /// What to say where something would have passed, and where the search's time stands.
  virtual std::string_view held_back() const = 0;
  virtual std::string_view search_phase() const = 0;
  /// The effect, in a step's report.
  virtual std::string_view phase() const = 0;

 private:
  /// Those at particles' present positions, `x`, as `late_`.
  void find_late(const Positions& x);
  /// Whether a pair that is not known is too near.
  bool misses_any(const Positions& x);
  bool is_known(const PairContact& pair) const;

  std::unique_ptr<PairDetection> detection_;
  double thickness_;  // [m]
  PairContacts pairs_;
  PairForces forces_, forces_before_;          // of the last step, and of the one before
  bool keeps_forces_ = false;                  // whether the running step's solver begins with them
  std::vector<PairContact::Simplices> known_;  // of pairs_, in order
  std::vector<PairContact> late_;              // that iterations came to
  Positions late_at_;                          // there, in the running step
  PairContacts rest_;                 // of the rest of the path, where something would have passed
  std::size_t first_constraint_ = 0;  // of its pairs, among those that were asked for last
  std::size_t found_first_ = 0;       // of its pairs: those beyond were found late
  bool has_late_ = false;             // whether anybody looked for those
  bool has_rest_ = false, is_held_back_ = false;  // in the running step
  const Particles* particles_ = nullptr;          // of the running step
  double dt_ = 0.0;
  Eigen::VectorXd inertia_;  // of particles: what a force moves them in a step [m/N]
};

}  // namespace pliant
