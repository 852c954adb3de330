#include "pliant/models/registry.h"

#include "pliant/models/cloth/cloth.h"
#include "pliant/models/patch/patch.h"
#include "pliant/models/reduced/reduced_body.h"
#include "pliant/models/rigid/rigid.h"
#include "pliant/models/viscoelastic/viscoelastic.h"

namespace pliant {

const ModelRegistry& model_registry() {
  static const ModelRegistry registry = [] {
    ModelRegistry built("model");
    built.add(cloth_entry());
    built.add(patch_entry());
    built.add(reduced_entry());
    built.add(viscoelastic_entry());
    built.add(rigid_entry());
    return built;
  }();
  return registry;
}

}  // namespace pliant
