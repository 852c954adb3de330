#pragma once

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

  void reset() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

 private:
  BlendedClusters* solid_;  // one of the elements
};

}  // namespace pliant
