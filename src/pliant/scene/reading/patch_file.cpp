#include "pliant/scene/reading/patch_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/error.h"
#include "pliant/scene/yaml/text_file.h"
#include "pliant/scene/yaml/yaml_map.h"

namespace pliant {
namespace {

constexpr std::size_t kMaxBytes = 500'000'000;
constexpr double kMaxNumber = std::numeric_limits<double>::max();

Eigen::Matrix3Xd read_vertices(const YamlNode& node) {
  const char* expected = "a list of [x, y, z] in m";
  const auto& items = read_list(node, "vertices", expected);
  Eigen::Matrix3Xd vertices(3, static_cast<Eigen::Index>(items.size()));
  for (std::size_t v = 0; v < items.size(); ++v) {
    const auto x = read_numbers(items[v], fmt::format("vertices[{}]", v), 3, 3, -kMaxNumber,
                                kMaxNumber, "[x, y, z] in m");
    vertices.col(static_cast<Eigen::Index>(v)) << x[0], x[1], x[2];
  }
  return vertices;
}

/// `count` whole numbers that name vertices.
std::vector<int> read_indices(const YamlNode& node, const std::string& field, int count,
                              Eigen::Index vertices) {
  const std::string expected =
      fmt::format("{} vertices, whole numbers in [0, {}]", count, vertices - 1);
  const auto numbers =
      read_numbers(node, field, count, count, 0.0, static_cast<double>(vertices - 1), expected);
  std::vector<int> indices;
  for (const double number : numbers) {
    if (number != std::floor(number)) refuse_value(node, field, expected);
    indices.push_back(static_cast<int>(number));
  }
  return indices;
}

Eigen::Matrix3Xi read_triangles(const YamlNode& node, Eigen::Index vertices) {
  const auto& items = read_list(node, "triangles", "a list of [a, b, c]");
  Eigen::Matrix3Xi triangles(3, static_cast<Eigen::Index>(items.size()));
  for (std::size_t t = 0; t < items.size(); ++t) {
    const auto v = read_indices(items[t], fmt::format("triangles[{}]", t), 3, vertices);
    triangles.col(static_cast<Eigen::Index>(t)) << v[0], v[1], v[2];
  }
  return triangles;
}

void read_edges(const YamlNode& node, PatchBody& body) {
  body.edges = edges(body.base).vertices;
  body.quadrics.resize(body.edges.size());
  std::vector<char> given(body.edges.size(), 0);
  const auto& items = read_list(node, "edges", "a list of {vertices: [a, b], quadric: [...]}");
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string field = fmt::format("edges[{}]", i);
    const YamlMap map(items[i], field, {}, {"vertices", "quadric"});
    const auto ends = read_indices(map.require("vertices", "[a, b]"), map.field("vertices"), 2,
                                   body.base.vertices.cols());
    const std::array<int, 2> edge = {std::min(ends[0], ends[1]), std::max(ends[0], ends[1])};
    const auto place = std::lower_bound(body.edges.begin(), body.edges.end(), edge);
    const auto e = static_cast<std::size_t>(place - body.edges.begin());
    if (place == body.edges.end() || *place != edge || given[e] != 0) {
      refuse_value(*map.find("vertices"), map.field("vertices"),
                   "the ends of an edge of the triangles that has no quadric yet");
    }
    given[e] = 1;
    const auto numbers = read_numbers(map.require("quadric", "10 numbers"), map.field("quadric"),
                                      10, 10, -kMaxNumber, kMaxNumber, "10 finite numbers");
    body.quadrics[e] = Eigen::Map<const Quadric>(numbers.data());
  }
  const auto missing = std::find(given.begin(), given.end(), 0);
  if (missing == given.end()) return;
  const auto& [a, b] = body.edges[static_cast<std::size_t>(missing - given.begin())];
  throw InputError(fmt::format("{}: edges lacks a quadric for the edge of vertices {} and {}",
                               node.place().text(), a, b));
}

}  // namespace

PatchBody parse_patch_body(const std::string& text, const std::string& file) {
  const YamlNode root = parse_yaml(text, file);
  const YamlMap map(root, "", {flag_parameter("dents", "true", "")},
                    {"vertices", "triangles", "edges"});
  PatchBody body;
  body.dents = map.flag("dents");
  body.base.vertices = read_vertices(map.require("vertices", "a list of [x, y, z] in m"));
  body.base.triangles =
      read_triangles(map.require("triangles", "a list of [a, b, c]"), body.base.vertices.cols());
  validate(body.base, file);
  read_edges(map.require("edges", "a list of {vertices: [a, b], quadric: [...]}"), body);
  validate(body, file);
  return body;
}

PatchBody read_patch_body(const std::string& path) {
  return parse_patch_body(read_text_file(path, kMaxBytes), path);
}

std::string patch_body_text(const PatchBody& body) {
  std::string text = fmt::format("dents: {}\nvertices:\n", body.dents);
  const auto out = std::back_inserter(text);
  for (const auto v : body.base.vertices.colwise()) {
    fmt::format_to(out, "- [{}, {}, {}]\n", v[0], v[1], v[2]);
  }
  text += "triangles:\n";
  for (const auto t : body.base.triangles.colwise()) {
    fmt::format_to(out, "- [{}, {}, {}]\n", t[0], t[1], t[2]);
  }
  text += "edges:\n";
  for (std::size_t e = 0; e < body.edges.size(); ++e) {
    const Quadric& q = body.quadrics[e];
    fmt::format_to(out, "- {{vertices: [{}, {}], quadric: [{}", body.edges[e][0], body.edges[e][1],
                   q[0]);
    for (int k = 1; k < 10; ++k) fmt::format_to(out, ", {}", q[k]);
    text += "]}\n";
  }
  return text;
}

void write_patch_body(const std::string& path, const PatchBody& body) {
  write_file_atomically(path, patch_body_text(body));
}

}  // namespace pliant
