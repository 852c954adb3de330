#pragma once

#include <array>
#include <vector>

namespace pliant {

using CornerTetrahedron = std::array<int, 4>;

/// Cuts a prism, its triangles top and bottom joined by the edges top[k] - bottom[k], into three
/// tetrahedra. rises[k] says which diagonal the quadrilateral between edges k and k + 1 has:
/// top[k] - bottom[k + 1] where true, bottom[k] - top[k + 1] where not. Not all three may be alike:
/// such a prism has no tetrahedra without a further vertex.
void cut_prism(const std::array<int, 3>& top, const std::array<int, 3>& bottom,
               const std::array<bool, 3>& rises, std::vector<CornerTetrahedron>& result);

}  // namespace pliant
