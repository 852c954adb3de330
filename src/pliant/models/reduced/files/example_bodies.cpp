#include "pliant/models/reduced/files/example_bodies.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "pliant/math/error.h"
#include "pliant/models/reduced/files/smooth_bodies.h"
#include "pliant/models/reduced/files/voxel_mesh.h"

namespace pliant {
namespace {

using Point = Eigen::Vector3d;
using Inside = std::function<bool(const Point&)>;

bool in_box(const Point& p, const Point& low, const Point& high) {
  return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
}

std::vector<int> vertices_where(const TetrahedralMesh& mesh, const Inside& condition) {
  std::vector<int> found;
  for (int v = 0; v < static_cast<int>(mesh.vertices.cols()); ++v) {
    if (condition(mesh.vertices.col(v))) found.push_back(v);
  }
  return found;
}

int nearest_vertex(const TetrahedralMesh& mesh, const Point& p) {
  Eigen::Index nearest = 0;
  (mesh.vertices.colwise() - p).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

struct ExampleShape {
  VoxelGrid grid;
  Inside inside;
  Inside fixed;
  Point loaded;
  Point load;
};

ExampleShape beam() {
  return {{{0.0, -0.06, -0.04}, {1.0, 0.06, 0.04}, {24, 4, 3}},
          [](const Point&) { return true; },
          [](const Point& p) { return p.x() < 1e-9; },
          {1.0, 0.06, 0.04},
          {0.0, 0.3, 1.0}};
}

ExampleShape basket() {
  return {{{-0.5, -0.3, 0.0}, {0.5, 0.3, 0.9}, {20, 12, 18}},
          [](const Point& p) {
            const bool outer = in_box(p, {-0.5, -0.3, 0.0}, {0.5, 0.3, 0.4});
            const bool hollow = in_box(p, {-0.4, -0.2, 0.1}, {0.4, 0.2, 0.4});
            const double radius = std::hypot(p.x(), p.z() - 0.4);
            const bool handle =
                std::abs(p.y()) < 0.1 && p.z() > 0.4 && radius > 0.38 && radius < 0.5;
            return (outer && !hollow) || handle;
          },
          [](const Point& p) { return p.z() < 1e-9; },
          {0.0, 0.05, 0.9},
          {0.3, 1.0, 0.2}};
}

ExampleShape bridge() {
  return {{{-1.0, -0.15, 0.0}, {1.0, 0.15, 0.6}, {40, 6, 12}},
          [](const Point& p) {
            const bool deck = p.z() > 0.5;
            const double radius = std::hypot(p.x() / 0.95, p.z() / 0.55);
            const bool arch = radius > 0.82 && radius < 1.02 && p.z() < 0.5;
            const bool pillar = std::abs(std::abs(p.x()) - 0.5) < 0.051 && p.z() > 0.3;
            return deck || arch || pillar;
          },
          [](const Point& p) { return p.z() < 1e-9 || (std::abs(p.x()) > 0.999); },
          {0.0, 0.15, 0.6},
          {0.0, 0.2, -1.0}};
}

ExampleShape quadruped() {
  return {{{-0.7, -0.2, 0.0}, {0.9, 0.2, 1.4}, {32, 8, 28}},
          [](const Point& p) {
            const bool trunk = in_box(p, {-0.5, -0.2, 0.6}, {0.5, 0.2, 0.95});
            const bool leg =
                p.z() < 0.6 && std::abs(std::abs(p.x()) - 0.4) < 0.1 && std::abs(p.y()) > 0.05;
            const double along = p.x() - 0.4 - 0.5 * (p.z() - 0.95);
            const bool neck = p.z() >= 0.9 && std::abs(p.y()) < 0.1 && std::abs(along) < 0.14;
            const bool head = in_box(p, {0.5, -0.1, 1.15}, {0.9, 0.1, 1.35});
            const bool tail = in_box(p, {-0.65, -0.05, 0.5}, {-0.45, 0.05, 0.9});
            return trunk || leg || neck || head || tail;
          },
          [](const Point& p) { return p.z() < 1e-9; },
          {0.9, 0.1, 1.25},
          {-0.3, 1.0, 0.0}};
}

ExampleShape tower() {
  return {{{-0.3, -0.3, 0.0}, {0.3, 0.3, 2.0}, {12, 12, 40}},
          [](const Point& p) {
            // Four legs that lean inwards, a floor each half metre, and a mast.
            const double half = 0.3 - 0.11 * p.z();
            const double x = std::abs(p.x()), y = std::abs(p.y());
            if (x > half || y > half) return false;
            const bool leg = x > half - 0.11 && y > half - 0.11;
            const bool floor = std::fmod(p.z(), 0.5) > 0.4;
            const bool mast = p.z() > 1.5 && x < 0.1 && y < 0.1;
            return leg || floor || mast;
          },
          [](const Point& p) { return p.z() < 1e-9; },
          {0.05, 0.05, 2.0},
          {1.0, 0.4, 0.0}};
}

ExampleShape heart() {
  return {{{-1.2, -0.7, -1.05}, {1.2, 0.7, 1.25}, {18, 11, 18}},
          [](const Point& p) {
            // G. Taubin's heart: (x² + 9/4 y² + z² - 1)³ - x² z³ - 9/80 y² z³ < 0.
            const Eigen::Array3d s = p.array().square();
            const double sphere = s[0] + 2.25 * s[1] + s[2] - 1.0;
            return sphere * sphere * sphere < (s[0] + 9.0 / 80.0 * s[1]) * s[2] * p.z();
          },
          [](const Point& p) { return p.z() < -0.65; },
          {0.6, 0.4, 0.9},
          {0.5, -1.0, 0.3}};
}

struct Entry {
  const char* name;
  const char* description;
  ExampleShape (*shape)();
  double young;  // [Pa]
  int modes;
  int rank;
};

// The thesis does not give its materials. Young's modulus is such that its own split, frequencies
// below and above 1/h at h = 0.003 s, falls where it did: 9/6, 15/5, 13/2, 9/6, 11/9, 27/3.
constexpr Entry kEntries[] = {
    {"beam", "a beam fixed at one end", beam, 2.6e7, 10, 15},
    {"basket", "a basket with a handle, its floor fixed", basket, 4.5e7, 12, 20},
    {"bridge", "a bridge on an arch, fixed at its feet and ends", bridge, 6.8e7, 10, 15},
    {"quadruped", "a quadruped like a horse, its feet fixed", quadruped, 1.8e9, 10, 15},
    {"tower", "a tower on four legs, its feet fixed", tower, 4.5e9, 12, 20},
    {"heart", "a heart, its tip fixed", heart, 2e8, 15, 30},
};

struct SmoothEntry {
  const char* name;
  const char* description;
  SmoothShape (*shape)();
  ElasticMaterial material;
  int modes;
  int rank;
};

// Moduli at 100 % elongation as makers of such silicones give them: gels and the softest ones 30 to
// 70 kPa (muscle at rest is as soft), casting silicones 0.15 to 0.6 MPa, polyurethane rubbers from
// 1 MPa on.
constexpr SmoothEntry kSmoothEntries[] = {
    {"soft_heart",
     "a smooth heart of soft silicone, 68 mm wide, its tip fixed",
     smooth_heart,
     {3e4, 0.3, 1000.0},
     15,
     30},
    {"rubber_bridge",
     "a bridge of casting silicone on two arches, 0.4 m long",
     smooth_bridge,
     {2e5, 0.3, 1080.0},
     10,
     15},
    {"rubber_tower",
     "a tower of polyurethane rubber on four legs, 0.4 m high",
     smooth_tower,
     {2e6, 0.3, 1050.0},
     12,
     20},
    {"rubber_horse",
     "a horse of firm silicone, 0.3 m high, its hooves fixed",
     smooth_horse,
     {6e5, 0.3, 1080.0},
     10,
     15},
};

template <class Entries>
const auto* find_entry(const Entries& entries, const std::string& name) {
  const auto* found = std::find_if(std::begin(entries), std::end(entries),
                                   [&](const auto& entry) { return name == entry.name; });
  return found == std::end(entries) ? nullptr : found;
}

[[noreturn]] void refuse_unknown(const std::string& name) {
  throw InputError(unknown_name_message("body", name, example_names()));
}

ExampleBody voxel_body(const Entry& entry) {
  const ExampleShape shape = entry.shape();
  ExampleBody body;
  body.mesh = mesh_voxels(shape.grid, shape.inside, entry.name);
  body.fixed = vertices_where(body.mesh, shape.fixed);
  body.material = {entry.young, 0.3, 1000.0};
  body.reduction = {entry.modes, entry.rank, MassMatrix::kConsistent};
  body.loaded = nearest_vertex(body.mesh, shape.loaded);
  body.load = shape.load.normalized();
  return body;
}

ExampleBody smooth_body(const SmoothEntry& entry) {
  const SmoothShape shape = entry.shape();
  StuffedShape stuffed =
      stuff_shape(shape.shape, shape.cell_size, shape.surface_spacing, entry.name);
  ExampleBody body;
  body.mesh = std::move(stuffed.mesh);
  body.surface = std::move(stuffed.surface);
  body.fixed = vertices_where(body.mesh, shape.fixed);
  body.material = entry.material;
  body.reduction = {entry.modes, entry.rank, MassMatrix::kConsistent};
  body.loaded = nearest_vertex(body.mesh, shape.loaded);
  body.load = shape.load.normalized();
  return body;
}

}  // namespace

std::vector<std::string> thesis_body_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kEntries) names.emplace_back(entry.name);
  return names;
}

std::vector<std::string> example_names() {
  std::vector<std::string> names = thesis_body_names();
  for (const SmoothEntry& entry : kSmoothEntries) names.emplace_back(entry.name);
  return names;
}

std::string example_description(const std::string& name) {
  if (const Entry* entry = find_entry(kEntries, name)) return entry->description;
  if (const SmoothEntry* entry = find_entry(kSmoothEntries, name)) return entry->description;
  refuse_unknown(name);
}

ExampleBody example_body(const std::string& name) {
  const Entry* entry = find_entry(kEntries, name);
  const SmoothEntry* smooth = find_entry(kSmoothEntries, name);
  if (entry == nullptr && smooth == nullptr) refuse_unknown(name);
  ExampleBody body = entry != nullptr ? voxel_body(*entry) : smooth_body(*smooth);
  body.name = name;
  return body;
}

}  // namespace pliant
