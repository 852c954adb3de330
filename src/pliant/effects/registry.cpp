#include "pliant/effects/registry.h"

#include "pliant/effects/air.h"
#include "pliant/effects/contact.h"
#include "pliant/effects/damping.h"
#include "pliant/effects/friction.h"
#include "pliant/effects/gravity.h"

namespace pliant {

const EffectRegistry& effect_registry() {
  static const EffectRegistry registry = [] {
    EffectRegistry built("effect");
    // Couplings relax in this order: contact has to undo what air pressed into obstacles, and
    // friction needs contact's normal forces.
    built.add(gravity_entry());
    built.add(damping_entry());
    built.add(air_entry());
    built.add(contact_entry());
    built.add(friction_entry());
    return built;
  }();
  return registry;
}

}  // namespace pliant
