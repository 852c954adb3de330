#pragma once

#include <utility>

#include "pliant/core/system/system.h"
#include "pliant/models/viscoelastic/blended_clusters.h"
#include "pliant/models/viscoelastic/liquid.h"

namespace pliant {

/// Particles between solid and liquid: what a solver moves, and what the model keeps of them.
class BlendedSystem final : public ProjectiveSystem {
 public:
  explicit BlendedSystem(bool oriented, TurnBlend blend = TurnBlend::kMoments);

  BlendedClusters& solid() { return *solid_; }
  const BlendedClusters& solid() const { return *solid_; }

  Liquid liquid;
  LiquidWalls walls;
  Eigen::VectorXd beta;     ///< 0 solid to 1 liquid
  double unfollowed = 0.0;  ///< since clusters followed beta [s]
  double counted_step = 0;  ///< number of the last step in that time: taken anew, it counts once

  /// From now on what friction takes of the motion of its particles is kept in motion_losses.
  void keep_losses();
  bool keeps_losses() const { return keeps_losses_; }
  /// Adds to what each particle lost [J].
  void note_motion_losses(const Eigen::VectorXd& losses);
  /// What each lost since this was asked last [J]; empty: nothing.
  Eigen::VectorXd take_motion_losses() { return std::exchange(motion_losses_, {}); }
  bool flows() const override { return liquid.acts(beta); }
  void scale_velocities(double factor) override;
  void reset() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

 private:
  BlendedClusters* solid_;  // one of the elements
  bool keeps_losses_ = false;
  Eigen::VectorXd motion_losses_;
};

}  // namespace pliant
