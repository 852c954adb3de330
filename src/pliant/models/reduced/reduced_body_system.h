#pragma once

#include <optional>

#include "pliant/core/system/responding_system.h"
#include "pliant/models/reduced/reduced_attachments.h"
#include "pliant/models/reduced/reduced_contact.h"
#include "pliant/models/reduced/step_balance.h"
#include "pliant/models/reduced/stretch_watch.h"

namespace pliant {

/// A reduced system as a body of a world: its particles are the full mesh's vertices, which follow
/// q and p after each step; forces on them, attachments and contact with obstacles move q and p. In
/// a group of bodies its steps stay open until the forces between the bodies are found.
class ReducedBodySystem final : public ReducedSystem,
                                public HoldsAttachments,
                                public RespondingSystem {
 public:
  /// `touching`: the points that touch. `fast` is the frequency from which on coordinates count as
  /// fast [Hz]; 0: h ω >= 1.
  ReducedBodySystem(const ReducedModel& model, const RayleighDamping& rayleigh, double fast,
                    EmbeddedPoints touching);
  ReducedBodySystem(const ReducedBodySystem&) = delete;
  ReducedBodySystem& operator=(const ReducedBodySystem&) = delete;

  const ReducedVertices& vertices() const { return vertices_; }
  const EmbeddedPoints& touching() const { return touching_; }
  const StretchWatch& stretches() const { return stretches_; }
  void place(const Eigen::Isometry3d& world_from_body);
  /// Sets the particles by q and p.
  void move_particles();
  /// The first coordinate that counts as fast at a time step of h seconds.
  int first_fast(double h) const;

  void add_attachments(std::unique_ptr<AttachmentSet> set) override;
  double elastic_energy() const override;
  void take_response(const StepResponse& response) override;
  void begin_step(double h) override;
  void end_step(double h, const StepResponse& response, StepReport& report) override;
  void scale_velocities(double factor) override;
  RespondingSystem* as_responding() override { return this; }
  void keep_open(bool is_open) override { stays_open_ = is_open; }
  void move(const Forces& f, Positions& x) override;
  void respond(const std::vector<int>& at, Eigen::Ref<Forces> v) override;
  double answer(int particle) override;
  const Eigen::MatrixXd& inverse_response() override;
  void close(double share, double dt) override;
  Eigen::VectorXd& momenta() override { return p; }
  void add_rows(int particle, double weight, Eigen::Ref<Eigen::MatrixXd> rows) const override;
  void take_impulses(const Eigen::VectorXd& impulses, double dt) override;
  void undo_step() override;
  void reset() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

 protected:
  void* offer(const std::type_info& type) override {
    return offer_as<HoldsAttachments>(this, type);
  }

 private:
  /// What the running step answers forces with, and where contact with obstacles stands.
  ReducedContact::Step contact_step(ContactEffect& effect) const;
  /// Of energy that was taken back [J].
  void tell_taken(double energy);
  /// Nothing changes q and p any more.
  void finish_step();

  ReducedVertices vertices_;
  EmbeddedPoints touching_;
  ReducedAttachments attachments_;
  ReducedContact contact_;
  StretchWatch stretches_;
  StepBalance balance_;
  double fast_;  // [Hz]
  Eigen::VectorXd q_start_, p_start_;
  // Of the running step.
  double h_ = 0.0;                           // [s]
  std::optional<ReducedResponse> response_;  // with attachments
  ContactEffect* touched_ = nullptr;         // null: nothing keeps it from obstacles
  StepReport* report_ = nullptr;
  // Forces of other bodies, Uᵀ f [kg^½ m/s²].
  bool stays_open_ = false;
  Eigen::VectorXd guess_, guess_start_;  // of the step before
  Eigen::VectorXd from_others_;          // found so far
  Eigen::VectorXd reduced_, moved_;
  Eigen::MatrixXd inverse_response_;
  bool knows_inverse_ = false;  // of response_
};

}  // namespace pliant
