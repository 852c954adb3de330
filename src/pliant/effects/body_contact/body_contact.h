#pragma once

#include <memory>

#include "pliant/effects/body_contact/body_contact_detection.h"
#include "pliant/effects/contact/pair_contact_effect.h"
#include "pliant/effects/contact/restored_shape.h"

namespace pliant {

/// Keeps the bodies of a group out of each other. The first of them holds it for all.
class BodyContactEffect final : public PairContactEffect {
 public:
  /// `owned` is `detection`.
  BodyContactEffect(std::unique_ptr<PairDetection> owned, BodyContactDetection& detection,
                    double thickness);
  std::string_view name() const override { return "body_contact"; }
  Constraint* constraint_between_bodies() override { return this; }
  void begin_step(const Particles& particles, double dt) override;
  void final_projection(const Eigen::VectorXd& mobility, Positions& x) override;
  void after_step(Body& body, double dt) override;
  void undo_step() override;
  void reset(Body& body) override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

 protected:
  bool is_between_bodies() const override { return true; }

 private:
  /// Friction takes back what bodies that stuck to each other came off by as they got their shapes
  /// back.
  void take_back();
  void note_restored();

  std::string_view held_back() const override;
  std::string_view search_phase() const override { return "body_contact_search"; }
  std::string_view phase() const override { return name(); }

  BodyContactDetection& detection_;
  const Particles* particles_ = nullptr;  // of the running step
  double opened_before_ = 0.0;            // the running step [m]
  RestoredShape restored_;
};

EffectRegistry::Entry body_contact_entry();

}  // namespace pliant
