#include "pliant/elements/coloring.h"

#include <cstdint>

namespace pliant {
namespace {

constexpr int kColorsPerRound = 64;

/// Colours what it can with 64 colours from `first_color` on; elements left over keep -1.
bool color_round(const std::vector<int>& vertices, const std::vector<int>& begins, int particles,
                 int first_color, std::vector<int>& color) {
  std::vector<std::uint64_t> used(static_cast<std::size_t>(particles), 0);
  bool complete = true;
  for (std::size_t e = 0; e < color.size(); ++e) {
    if (color[e] >= 0) continue;
    const int* begin = vertices.data() + begins[e];
    const int* end = vertices.data() + begins[e + 1];
    std::uint64_t taken = 0;
    for (const int* v = begin; v != end; ++v) taken |= used[static_cast<std::size_t>(*v)];
    if (taken == ~std::uint64_t{0}) {
      complete = false;
      continue;
    }
    const int free_color = __builtin_ctzll(~taken);
    for (const int* v = begin; v != end; ++v) {
      used[static_cast<std::size_t>(*v)] |= std::uint64_t{1} << free_color;
    }
    color[e] = first_color + free_color;
  }
  return complete;
}

}  // namespace

Coloring color_elements(const std::vector<int>& vertices, int arity, int particles) {
  std::vector<int> begins(vertices.size() / static_cast<std::size_t>(arity) + 1);
  for (std::size_t e = 0; e < begins.size(); ++e) begins[e] = static_cast<int>(e) * arity;
  return color_elements(vertices, begins, particles);
}

Coloring color_elements(const std::vector<int>& vertices, const std::vector<int>& begins,
                        int particles) {
  std::vector<int> color(begins.size() - 1, -1);
  for (int first = 0; !color_round(vertices, begins, particles, first, color);) {
    first += kColorsPerRound;
  }
  int colors = 0;
  for (int c : color) colors = std::max(colors, c + 1);
  Coloring result;
  result.begins.assign(static_cast<std::size_t>(colors) + 1, 0);
  for (int c : color) ++result.begins[static_cast<std::size_t>(c) + 1];
  for (int c = 0; c < colors; ++c) {
    result.begins[static_cast<std::size_t>(c) + 1] += result.begins[static_cast<std::size_t>(c)];
  }
  result.order.resize(color.size());
  std::vector<int> next(result.begins.begin(), result.begins.end() - 1);
  for (std::size_t e = 0; e < color.size(); ++e) {
    int& place = next[static_cast<std::size_t>(color[e])];
    result.order[static_cast<std::size_t>(place++)] = static_cast<int>(e);
  }
  return result;
}

}  // namespace pliant
