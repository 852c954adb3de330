#include "pliant/models/registry.h"

#include "pliant/models/cloth/cloth.h"
#include "pliant/models/patch/patch.h"

namespace pliant {

const ModelRegistry& model_registry() {
  static const ModelRegistry registry = [] {
    ModelRegistry built("model");
    built.add(cloth_entry());
    built.add(patch_entry());
    return built;
  }();
  return registry;
}

}  // namespace pliant
