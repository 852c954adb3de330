#pragma once

#include <vector>

namespace pliant {

/// Order of elements such that those of one colour share no particle.
struct Coloring {
  std::vector<int> order;  ///< element numbers, colour by colour
  std::vector<int>
      begins;  ///< first place in `order` of each colour, and its end: colours + 1 entries
  int colors() const { return static_cast<int>(begins.size()) - 1; }
};

/// Greedy colouring in element order. `vertices` holds `arity` particles per element, one element
/// after the other.
Coloring color_elements(const std::vector<int>& vertices, int arity, int particles);

/// The same for elements of any size: the particles of element e are vertices[begins[e]] to
/// vertices[begins[e + 1] - 1].
Coloring color_elements(const std::vector<int>& vertices, const std::vector<int>& begins,
                        int particles);

}  // namespace pliant
