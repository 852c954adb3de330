#pragma once

#include <string>
#include <vector>

#include "pliant/study/generated/generated_body.h"

namespace pliant {

/// An effect's name and what stands behind it: "contact", "thickness: 0.002".
struct EffectText {
  std::string name, parameters;
};

/// What the factors `effects` and `self_contact` name, as far as the model has such. `on_plane`:
/// there is something on which air can be sealed.
std::vector<EffectText> effects_of(const SceneChoice& choice, const SceneUnits& units,
                                   bool on_plane);
/// All that act on a body of `model` (cloth or viscoelastic) and that are not among `named`.
std::vector<EffectText> other_effects(const std::string& model, const SceneUnits& units,
                                      const std::vector<EffectText>& named);
bool has_effect(const std::vector<EffectText>& effects, const std::string& name);

}  // namespace pliant
