#include "pliant/effects/strain_limit/yarns.h"

#include "pliant/elements/coloring.h"

namespace pliant {
namespace {

Yarns color(const std::vector<Yarn>& yarns, int particles) {
  std::vector<int> vertices, begins = {0};
  for (const Yarn& yarn : yarns) {
    const auto count = yarn.weights[2] == 0.0 && yarn.particles[2] == yarn.particles[0] ? 2 : 3;
    vertices.insert(vertices.end(), yarn.particles.begin(), yarn.particles.begin() + count);
    begins.push_back(static_cast<int>(vertices.size()));
  }
  const Coloring coloring = color_elements(vertices, begins, particles);
  Yarns sorted;
  sorted.begins = coloring.begins;
  sorted.all.reserve(yarns.size());
  for (const int t : coloring.order) sorted.all.push_back(yarns[static_cast<std::size_t>(t)]);
  return sorted;
}

}  // namespace

Yarns find_yarns(const std::vector<std::unique_ptr<ElementSet>>& elements, int particles) {
  std::vector<Yarn> yarns;
  for (const auto& set : elements) {
    if (const HasYarns* cloth = set->find<HasYarns>()) cloth->add_yarns(yarns);
  }
  return color(yarns, particles);
}

std::vector<ClothEdge> find_edges(const std::vector<std::unique_ptr<ElementSet>>& elements) {
  std::vector<ClothEdge> edges;
  for (const auto& set : elements) {
    if (const HasYarns* cloth = set->find<HasYarns>()) cloth->add_edges(edges);
  }
  return edges;
}

}  // namespace pliant
