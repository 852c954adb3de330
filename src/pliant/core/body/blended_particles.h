#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pliant/core/body/heat_properties.h"
#include "pliant/core/body/particles.h"

namespace pliant {

class NeighborLists;
class PairSums;

/// Particles between solid and liquid, as effects see them: a model of such is one of these too.
class BlendedParticles {
 public:
  /// Particles [first, first + count) that were one body of the scene.
  struct Part {
    int first, count;
    HeatProperties heat;
  };

  virtual ~BlendedParticles() = default;

  /// All particles, part by part.
  virtual std::vector<Part> blended_parts() const = 0;
  /// Of each particle, 0 solid to 1 liquid.
  virtual const Eigen::VectorXd& beta() const = 0;
  /// Takes effect with the next step: melted particles leave their clusters, frozen ones join
  /// others in the shape that they then have.
  virtual void set_beta(int particle, double beta) = 0;
  /// Shapes of the groups that hold together follow the positions `x`, by `share` (0 to 1) of what
  /// is beyond the strain `yield`.
  virtual void creep(const Positions& x, double yield, double share) = 0;
  /// From now on what melting and creep take of the elastic energy is kept for take_losses(), and
  /// what friction within the body and damping take of its motion for take_motion_losses().
  virtual void keep_losses() = 0;
  virtual bool keeps_losses() const = 0;
  /// What each particle lost since this was asked last [J]; empty: no particle lost anything.
  virtual Eigen::VectorXd take_losses() = 0;
  virtual Eigen::VectorXd take_motion_losses() = 0;
  /// An effect took so much of each particle's motion [J].
  virtual void note_motion_losses(const Eigen::VectorXd& losses) = 0;
  /// Whether what is solid holds two particles of one part together, or lay them side by side when
  /// it was made.
  virtual bool are_bound(int i, int j) const = 0;
  /// At rest [m³].
  virtual const Eigen::VectorXd& volumes() const = 0;
  /// Within which particles feel each other [m].
  virtual double support() const = 0;
  /// Shows `values` of the particles, which outlive this, among the model's fields.
  virtual void show_field(const std::string& name, const Eigen::VectorXd* values) = 0;
  /// All pairs within the support at the positions `x`, and perhaps some beyond it.
  virtual const NeighborLists& neighbors(const Positions& x) = 0;
  /// What a device sums instead; null where there is none.
  virtual PairSums* pair_sums() { return nullptr; }
};

}  // namespace pliant
