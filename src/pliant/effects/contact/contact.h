#pragma once

#include <optional>

#include "pliant/core/effect.h"
#include "pliant/effects/contact/contact_detection.h"
#include "pliant/effects/contact/following_points.h"
#include "pliant/effects/contact/opening.h"
#include "pliant/effects/contact/pinching.h"
#include "pliant/effects/contact/redundant_contacts.h"
#include "pliant/effects/contact/surface_depth.h"
#include "pliant/effects/wetness/wet_contact.h"

namespace pliant {

/// Keeps a body's points out of obstacles: non-penetration without bounce, by projection onto the
/// tangent planes found in each step.
class ContactEffect final : public Effect, public Constraint, public TakesWetness {
 public:
  /// `embedded` outlives this; null: the particles touch. So does the `surface` of a body whose
  /// points that touch are not all of it; null: they are.
  /// And so do the `bends` of its surface about `embedded`; null: it is not smooth.
  ContactEffect(const std::vector<Obstacle>& obstacles, const EmbeddedPoints* embedded,
                const SurfaceBends* bends, const EmbeddedPoints* surface, double thickness,
                double margin);
  std::string_view name() const override { return "contact"; }
  /// Iterations have to answer what they moved into obstacles. Else, as of a sheet, which weighs
  /// little, the final projection is enough.
  void look_again() { looks_again_ = true; }
  /// Of a body that keeps its shape fewer contacts say the same.
  void leave_out_redundant() { leaves_out_redundant_ = true; }
  /// Whether its body does.
  bool keeps_shape() const { return leaves_out_redundant_; }
  /// Of a body that keeps its shape and has normal_cones(); it outlives this.
  void face_with(const Model& model) { faced_ = &model; }

  Constraint* constraint() override { return this; }
  void add_reactions(std::vector<Reaction>& reactions) const override;
  void reset(Body& body) override;
  void after_step(Body& body, double dt) override;
  void undo_step() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;
  /// A solver that takes a resident run knows the constraint itself.
  bool join_resident_run(ResidentRun& run) const override;

  void begin_step(const Particles& particles, double dt) override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& mobility, Positions& x) override;
  void add_forces(Forces& f) const override;
  void add_rows(const Positions& x, ConstraintRows& rows) override;
  /// Water that pulls lets go at a distance: what it holds is no convex function of that.
  bool takes_multipliers() const override { return wet_ == nullptr; }
  bool tells_point_constraints() const override { return true; }
  void warm_start() override;
  void add_point_constraints(const Positions& x, PointConstraints& constraints) override;
  void take_multipliers(const PointConstraints& constraints) override;
  bool is_idle() const override { return contacts_.empty(); }
  int active() const override;
  bool finds_more(const Positions& x, bool done) override;
  /// Finds what the iterations moved into obstacles and moves it back out.
  void final_projection(const Eigen::VectorXd& mobility, Positions& x) override;
  double alternating_projection(const Eigen::VectorXd& mobility, Positions& x) override;
  /// Looks what settling moved into obstacles.
  bool limit_displacement(Positions& x) override;
  void report(StepReport& report) const override;

  /// Appends what touches now, of the step that begin_step() began.
  void find(std::vector<Contact>& contacts) { detection_.find_again(*particles_, dt_, contacts); }

  void set_wetness(const WetContact* wet) override {
    wet_ = wet;
    detection_.widen_margin(wet->range);
  }

  /// Whether water may hold points.
  bool is_wet() const { return wet_ != nullptr; }

  /// Where the constraints of its contacts stand among those that were asked for last.
  std::size_t first_constraint() const { return first_constraint_; }
  std::vector<Contact>& contacts() { return contacts_; }
  const std::vector<Contact>& contacts() const { return contacts_; }
  const ContactPoints& points() const { return points_; }
  /// Distance that points keep from surfaces: half the thickness [m].
  double offset() const { return detection_.offset(); }
  double margin() const { return detection_.margin(); }  ///< [m]

 protected:
  void* offer(const std::type_info& type) override {
    return offer_as<ContactEffect, TakesWetness>(this, type);
  }

 private:
  /// Finds the contacts of the step, from the start on which bodies may have begun too deep.
  void find_opening(const Particles& particles);
  /// What is nearest to a point of a face need not be what is nearest to the face: contacts push
  /// only as the faces look that come together at their points.
  void turn_to_faces(std::vector<Contact>& contacts) const;
  /// Keeps those of `contacts` that others do not say already.
  void leave_out_redundant(std::vector<Contact>& contacts);
  /// Those at particles' present positions, as `late_`.
  void find_late();
  /// Whether one of those is too near to an obstacle that nothing was known to press against; where
  /// it `answers_each`, any that was not known. Else that contact with an obstacle spreads, as in
  /// each step of a body that is pressed flat, is left to the final projection.
  bool touches_another(const Positions& x, bool answers_each) const;
  /// Tells contacts, from `first` on, of the water at their points.
  void wet(std::size_t first, std::vector<Contact>& contacts) const;
  /// Pushes the point of a contact out, or holds it; returns how far it moved [m].
  double project(Contact& contact, const Eigen::VectorXd& mobility, Positions& x) const;
  /// Closes the contacts of particles to the last digit, after a solver that found the multipliers.
  void close(const Eigen::VectorXd& mobility, Positions& x);
  /// Of a move that no iteration answers any more: what it changes is momentum alone, m Δx/h², over
  /// the force that the move stands for.
  double momentum_share(const Contact& contact, const Eigen::VectorXd& mobility) const;
  /// Lists the points that contacts press from opposite sides.
  void find_pinched();
  bool is_pinched(const Contact& contact) const;
  /// Pushes all points out, until none moves much.
  void sweep(const Eigen::VectorXd& mobility, Positions& x);

  const std::vector<Obstacle>& obstacles_;
  FollowingPoints following_;
  ContactPoints points_;  // those that follow
  ContactDetection detection_;
  SurfaceDepth surface_depth_;
  Opening opening_;
  const Model* faced_ = nullptr;          // null: its faces are not known
  const WetContact* wet_ = nullptr;       // null: all is dry
  const Particles* particles_ = nullptr;  // of the running step
  double dt_ = 0.0;
  std::vector<Contact> contacts_;
  std::size_t found_first_ = 0;  // of contacts_: those beyond were found late
  std::vector<Contact> late_;    // that iterations came to
  bool looks_again_ = false;
  bool leaves_out_redundant_ = false;
  RedundantContacts redundant_;
  Pinching pinching_;
  std::vector<Contact> last_;                   // of the step before, where multipliers are kept
  std::vector<int> pinched_;                    // points, in order
  std::vector<Eigen::Vector3d> first_normals_;  // of a point's last contact
  std::size_t first_constraint_ = 0;
  bool kept_multipliers_ = false;   // likewise in the step before
  bool keeps_multipliers_ = false;  // a solver finds them itself in this step
  bool was_settled_ = false;        // since the obstacles were looked at
};

EffectRegistry::Entry contact_entry();

}  // namespace pliant
