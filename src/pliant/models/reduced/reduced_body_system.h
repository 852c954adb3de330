#pragma once

#include "pliant/models/reduced/reduced_attachments.h"
#include "pliant/models/reduced/reduced_contact.h"
#include "pliant/models/reduced/stretch_watch.h"

namespace pliant {

/// A reduced system as a body of a world: its particles are the full mesh's vertices, which follow
/// q and p after each step; forces on them, attachments and contact with obstacles move q and p.
class ReducedBodySystem final : public ReducedSystem, public HoldsAttachments {
 public:
  /// `touching`: the points that touch. `fast` is the frequency from which on coordinates count as
  /// fast [Hz]; 0: h ω >= 1.
  ReducedBodySystem(const ReducedModel& model, const RayleighDamping& rayleigh, double fast,
                    CarriedPoints touching);
  ReducedBodySystem(const ReducedBodySystem&) = delete;
  ReducedBodySystem& operator=(const ReducedBodySystem&) = delete;

  const ReducedVertices& vertices() const { return vertices_; }
  const CarriedPoints& touching() const { return touching_; }
  const StretchWatch& stretches() const { return stretches_; }
  void place(const Eigen::Isometry3d& world_from_body);
  /// Sets the particles by q and p.
  void move_particles();
  /// The first coordinate that counts as fast at a time step of h seconds.
  int first_fast(double h) const;

  void add_attachments(std::unique_ptr<AttachmentSet> set) override;
  double elastic_energy() const override;
  void begin_step(double h) override;
  void end_step(double h, const StepResponse& response, StepReport& report) override;
  void scale_velocities(double factor) override;
  void undo_step() override;
  void reset() override;
  void save(SavedNumbers& numbers) const override;
  void load(SavedNumbers& numbers) override;

 private:
  ReducedVertices vertices_;
  CarriedPoints touching_;
  ReducedAttachments attachments_;
  ReducedContact contact_;
  StretchWatch stretches_;
  double fast_;  // [Hz]
  Eigen::VectorXd q_start_, p_start_;
};

}  // namespace pliant
