#include "pliant/study/generated/generated_effects.h"

#include <fmt/format.h>

#include <algorithm>

namespace pliant {
namespace {

EffectText strain_limit_of_cloth() { return {"strain_limit", "max: 1.05"}; }

EffectText strain_limit_of_solids(const SceneUnits& u) {
  return {"strain_limit", "min: 0.7, max: 1.05, stiffness: " + u(1e5, 1, -1)};
}

EffectText wetness(const SceneUnits& u) {
  return {"wetness", fmt::format("wetness: 0.8, capacity: {}, adhesion: {}, adhesion_range: {}, "
                                 "permeability: {}, diffusion: {}, drainage: {}, drying: {}",
                                 u(0.2, 1, -2), u(1440.0, 1, -1), u(1e-4, 0, 1), u(2.5e-3, -1, 2),
                                 u(1e-6, 0, 2), u(1e-4, 0, 1), u(1e-3, 1, -2))};
}

EffectText air(const SceneUnits& u) {
  return {"air", fmt::format("volume: {}, atmosphere: {}, permeability: 0, seal_gap: {}",
                             u(2e-6, 0, 3), u(101325.0, 1, -1), u(0.002, 0, 1))};
}

EffectText volume(const SceneUnits& u) { return {"volume", "stiffness: " + u(1e5, 1, -1)}; }

EffectText heat(const SceneUnits& u) {
  return {"heat", fmt::format("initial_temperature: 304, latent_heat: {}, capacity: {}, "
                              "conductivity: {}, air_temperature: 330, convection: {}",
                              u(1e5, 0, 2), u(2000.0, 0, 2), u(0.2, 1, 1), u(10.0, 1, 0))};
}

EffectText surface_tension(const SceneUnits& u) {
  return {"surface_tension", "tension: " + u(0.07, 1, 0)};
}

EffectText xsph() { return {"xsph", "rate: 10"}; }
EffectText plasticity() { return {"plasticity", "yield: 0.02, rate: 10"}; }
EffectText damping() { return {"damping", "rate: 2"}; }

/// The model's own: of the values "first", "second" and "all".
std::vector<EffectText> own_effects(const std::string& model, int value, const SceneUnits& u,
                                    bool on_plane) {
  const bool first = value != 3, second = value != 2;
  std::vector<EffectText> effects;
  if (model == "cloth") {
    if (first) effects.push_back(strain_limit_of_cloth());
    if (second) effects.push_back(wetness(u));
    if (first && second && on_plane) effects.push_back(air(u));
  } else if (model == "patch") {
    if (first) effects.push_back(volume(u));
    if (second) effects.push_back(strain_limit_of_solids(u));
  } else if (model == "viscoelastic") {
    if (first) effects.push_back(plasticity());
    if (first) effects.push_back(xsph());
    if (second) effects.push_back(surface_tension(u));
    if (second) effects.push_back(heat(u));
  }
  return effects;
}

}  // namespace

bool has_effect(const std::vector<EffectText>& effects, const std::string& name) {
  return std::any_of(effects.begin(), effects.end(),
                     [&](const EffectText& effect) { return effect.name == name; });
}

std::vector<EffectText> effects_of(const SceneChoice& choice, const SceneUnits& units,
                                   bool on_plane) {
  const std::string& model = value_of(choice, kFactorModel);
  const int value = choice[kFactorEffects];
  std::vector<EffectText> effects;
  if (value >= 2) effects = own_effects(model, value, units, on_plane);
  for (EffectText& effect : effects) effect.parameters += ", bodies: [main]";
  if (value == 1 || value == 4) effects.push_back(damping());
  const bool may_touch_itself = model != "reduced" && model != "rigid";
  if (choice[kFactorSelfContact] > 0 && may_touch_itself) {
    effects.push_back({"self_contact", fmt::format("thickness: {}, margin: {}, friction: 0.4",
                                                   units(0.002, 0, 1), units(0.0005, 0, 1))});
  }
  return effects;
}

std::vector<EffectText> other_effects(const std::string& model, const SceneUnits& units,
                                      const std::vector<EffectText>& named) {
  std::vector<EffectText> effects = own_effects(model, 4, units, false);
  effects.push_back(damping());
  const auto is_named = [&](const EffectText& effect) { return has_effect(named, effect.name); };
  effects.erase(std::remove_if(effects.begin(), effects.end(), is_named), effects.end());
  return effects;
}

}  // namespace pliant
