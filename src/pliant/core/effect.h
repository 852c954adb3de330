#pragma once

#include <string_view>

#include "pliant/core/body/model.h"
#include "pliant/core/obstacle.h"
#include "pliant/core/registry.h"
#include "pliant/core/state_archive.h"
#include "pliant/core/step/resident_run.h"
#include "pliant/core/system/constraint.h"
#include "pliant/math/offers.h"

namespace pliant {

struct Body;
class BodyPairs;

/// What an effect may look at besides its own body.
struct EffectSite {
  Body& body;
  const std::vector<Obstacle>& obstacles;
  const BodyPairs& pairs;  ///< of the scene's bodies
};

/// Optional physics that a scene calls for. Every hook has an empty default; a scene that does not
/// name an effect holds no instance of it.
class Effect : public Offers {
 public:
  virtual std::string_view name() const = 0;
  /// Changes the body's elements for the coming step of `dt` [s], before it is known in how many
  /// substeps that is taken.
  virtual void change_elements(Body& /*body*/, double /*dt*/) {}
  /// Adds to the body's external forces, before each substep.
  virtual void before_step(Body& /*body*/, double /*dt*/) {}
  virtual void after_step(Body& /*body*/, double /*dt*/) {}
  /// Tells what it does in each substep of a resident run. False: nobody can tell before
  /// each step, or it has to act itself; then there is no such run.
  virtual bool join_resident_run(ResidentRun& /*run*/) const { return false; }
  /// The step that just ended is undone: forgets what it left. Not called for a step in substeps,
  /// nor where one of the body's effects remembers steps: save() is called before these, and load()
  /// after.
  virtual void undo_step() {}
  /// Whether after_step() changes what is kept from one step to the next, as heat and water do. It
  /// may have done so when the step is undone, since the step of another body failed.
  virtual bool remembers_steps() const { return false; }
  /// A condition that the solver has to meet, or null.
  virtual Constraint* constraint() { return nullptr; }
  /// A condition between the bodies of its body's group, on the particles of all; or null.
  virtual Constraint* constraint_between_bodies() { return nullptr; }
  /// Adds the forces of the last step on each obstacle.
  virtual void add_reactions(std::vector<Reaction>& /*reactions*/) const {}
  virtual double potential_energy(const Body& /*body*/) const { return 0.0; }  ///< [J]
  /// What of the particles a user may set while it runs. A field hides the model's of that name.
  virtual std::vector<SettableField> settable_fields() { return {}; }
  /// The body went back to its first state.
  virtual void reset(Body& /*body*/) {}
  /// What it keeps from one step to the next, and back; load() follows a reset().
  virtual void save(StateArchive& /*numbers*/) const {}
  virtual void load(StateArchive& /*numbers*/) {}
};

using EffectRegistry = Registry<Effect, const EffectSite&>;

}  // namespace pliant
