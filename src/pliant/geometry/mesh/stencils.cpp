#include "pliant/geometry/mesh/stencils.h"

#include <cassert>

namespace pliant {

void cut_prism(const std::array<int, 3>& top, const std::array<int, 3>& bottom,
               const std::array<bool, 3>& rises, std::vector<CornerTetrahedron>& result) {
  assert(rises[0] != rises[1] || rises[1] != rises[2]);
  // At one vertex of the top two diagonals meet: every tetrahedron has it as a corner.
  std::size_t k = 0;
  while (!(rises[k] && !rises[(k + 2) % 3])) ++k;
  const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
  result.push_back({top[k], bottom[k], bottom[l], bottom[m]});
  if (rises[l]) {
    result.push_back({top[k], top[l], top[m], bottom[m]});
    result.push_back({top[k], top[l], bottom[m], bottom[l]});
  } else {
    result.push_back({top[k], top[l], top[m], bottom[l]});
    result.push_back({top[k], top[m], bottom[m], bottom[l]});
  }
}

}  // namespace pliant
