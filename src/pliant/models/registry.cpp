#include "pliant/models/registry.h"

#include "pliant/models/cloth/cloth.h"

namespace pliant {

const ModelRegistry& model_registry() {
  static const ModelRegistry registry = [] {
    ModelRegistry built("model");
    built.add(cloth_entry());
    return built;
  }();
  return registry;
}

}  // namespace pliant
