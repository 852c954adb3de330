#include "pliant/effects/registry.h"

#include "pliant/core/add_new.h"
#include "pliant/effects/air/air.h"
#include "pliant/effects/body_contact/body_contact.h"
#include "pliant/effects/contact/contact.h"
#include "pliant/effects/contact/friction.h"
#include "pliant/effects/damping.h"
#include "pliant/effects/gravity.h"
#include "pliant/effects/particles/heat.h"
#include "pliant/effects/particles/plasticity.h"
#include "pliant/effects/particles/surface_tension.h"
#include "pliant/effects/particles/xsph.h"
#include "pliant/effects/self_contact/self_contact.h"
#include "pliant/effects/strain_limit/strain_limit.h"
#include "pliant/effects/volume.h"
#include "pliant/effects/wetness/wetness.h"

namespace pliant {
namespace {

EffectRegistry& effect_entries() {
  static EffectRegistry registry = [] {
    EffectRegistry built("effect");
    // Constraints relax in this order: contact has to undo what air and other parts of the body
    // pressed into obstacles, and friction needs contact's normal forces.
    built.add(gravity_entry());
    built.add(damping_entry());
    built.add(volume_entry());
    built.add(strain_limit_entry());
    built.add(air_entry());
    built.add(self_contact_entry());
    built.add(body_contact_entry());
    built.add(contact_entry());
    built.add(friction_entry());
    built.add(wetness_entry());
    built.add(heat_entry());
    built.add(surface_tension_entry());
    built.add(xsph_entry());
    built.add(plasticity_entry());
    return built;
  }();
  return registry;
}

}  // namespace

const EffectRegistry& effect_registry() { return effect_entries(); }

void add_effect(EffectRegistry::Entry entry) { add_new(std::move(entry), effect_entries()); }

}  // namespace pliant
