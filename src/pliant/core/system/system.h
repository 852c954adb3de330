#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/core/system/constraint.h"
#include "pliant/core/system/element_set.h"
#include "pliant/math/offers.h"

namespace pliant {

class ProjectiveSystem;
class RespondingSystem;

/// What a solver moves. A solver never knows which model it belongs to.
class System : public Offers {
 public:
  Particles particles;                   ///< every model has them; they need not be its unknowns
  std::vector<Constraint*> constraints;  ///< owned by the effects that brought them
  Forces external_forces;                ///< gravity, wind, the user's: set anew every step [N]
  /// Of contact with bodies that were moved together with this one, in the last step [N]; empty:
  /// there are none.
  Forces forces_of_bodies;
  /// Where a reset puts the particles; null: nobody said yet [m].
  const Positions* first_positions = nullptr;

  /// Itself, where element sets tie its particles; else null.
  virtual ProjectiveSystem* as_projective() { return nullptr; }
  /// Itself, where its particles follow coordinates and answer forces together; else null.
  virtual RespondingSystem* as_responding() { return nullptr; }

  virtual double elastic_energy() const = 0;                                    ///< [J]
  virtual double kinetic_energy() const { return particles.kinetic_energy(); }  ///< [J]
  virtual void scale_velocities(double factor) { particles.v *= factor; }
  /// Back to where the last step began.
  virtual void undo_step();
  /// Forgets what it kept from earlier steps besides positions and velocities.
  virtual void reset() {}
  /// What it keeps from one step to the next besides positions and velocities, and back.
  virtual void save(StateArchive& /*numbers*/) const {}
  virtual void load(StateArchive& /*numbers*/) {}
};

/// Particles tied by element sets: cloth, patch, the solid half of viscoelastic.
class ProjectiveSystem : public System {
 public:
  std::vector<std::unique_ptr<ElementSet>> elements;
  /// Particles that others move between a solver's iterations: [begin, end) each.
  std::vector<std::pair<int, int>> moved_by_others;
  /// A system whose particles, [begin, end) here, answer forces together.
  struct Responder {
    int begin, end;
    RespondingSystem* system;
    bool has(int particle) const { return begin <= particle && particle < end; }
    int size() const { return end - begin; }
  };
  std::vector<Responder> responders;

  ProjectiveSystem* as_projective() override { return this; }
  /// Gives what of its particles is a rigid body its shape back, at the pose nearest to `x`, which
  /// lies on a straight line between two others.
  virtual void keep_rigid(Positions& /*x*/) const {}

  /// Whether forces of a liquid act between its particles: solvers know them as external ones, and
  /// no matrix has what they resist.
  virtual bool flows() const { return false; }
  double elastic_energy() const override;
  /// Of sets that damp: half of what they dissipate in an effective step [J].
  double viscous_energy() const;
  void reset() override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;
};

}  // namespace pliant
