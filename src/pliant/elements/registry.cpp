#include "pliant/elements/registry.h"

namespace pliant {

const std::vector<ElementKind>& element_kinds() {
  static const std::vector<ElementKind> kinds = {
      {"stretch", "linear springs along warp and weft, or along the edges of a mesh"},
      {"shear", "linear springs along the diagonals of a grid's cells"},
      {"bending", "quadratic bending over the hinge of each inner edge"},
  };
  return kinds;
}

}  // namespace pliant
