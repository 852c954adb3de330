#include "fuzz/targets.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "pliant/core/checkpoint_file.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/io/tetrahedral_file.h"
#include "pliant/geometry/repair/collider_cache.h"
#include "pliant/geometry/repair/mesh_collider.h"
#include "pliant/math/error.h"
#include "pliant/models/reduced/files/cub_file.h"
#include "pliant/models/reduced/files/cub_model.h"
#include "pliant/models/reduced/files/reduced_file.h"
#include "pliant/scene/reading/patch_file.h"
#include "pliant/scene/robot/motion/keyframe_file.h"
#include "pliant/scene/robot/robot.h"
#include "pliant/scene/scene.h"
#include "pliant/scene/yaml/scene_value.h"
#include "pliant/study/accuracy/accuracy_row.h"
#include "unit/geometry/io/mesh_file_fixture.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

constexpr double kMostVertices = 1000;  // of a grid that is built: a mutation may ask for millions

/// A folder in memory for the files of this process.
const SceneFiles& folder() {
  static const SceneFiles files;
  return files;
}

std::string bytes_of(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

template <class Read>
FuzzTarget target(const std::string& name, std::vector<std::string> seeds, const Read& read) {
  return {name, std::move(seeds), [read](const std::string& bytes) {
            try {
              read(bytes);
              return true;
            } catch (const InputError& error) {
              if (std::string(error.what()).empty()) std::abort();
              return false;
            }
          }};
}

/// Of a reader of files with that ending.
template <class Read>
FuzzTarget file_target(const std::string& name, const std::string& ending,
                       std::vector<std::string> seeds, const Read& read) {
  return target(name, std::move(seeds), [read, ending](const std::string& bytes) {
    read(folder().write("input." + ending, bytes));
  });
}

FuzzTarget mesh(const std::string& ending, std::vector<std::string> seeds) {
  return file_target(ending, ending, std::move(seeds),
                     [](const std::string& path) { read_triangle_mesh(path); });
}

/// What `write` leaves at a path.
template <class Write>
std::string written(const std::string& name, const Write& write) {
  const std::string path = folder().path(name);
  write(path);
  return bytes_of(path);
}

// ---- seeds ------------------------------------------------------------------------------------

std::string tetrahedra_text(bool is_tetgen) {
  if (is_tetgen) {
    return "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n\x01"
           "1 4 0\n1 1 2 3 4\n";
  }
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 "
         "0\n"
         "0 1 0\n0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";
}

constexpr const char* kGmsh22 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 "
    "1\n$EndNodes\n"
    "$Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n";

constexpr const char* kVeg =
    "*VERTICES\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n*ELEMENTS\nTET\n1 4 0\n1 1 2 3 4\n"
    "*MATERIAL m\nENU, 1000, 1e6, 0.4\n*SET s\n1,\n*REGION\ns, m\n";

template <class Number>
void put(std::string& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// r = 1: a force of q + q^3.
std::string cub() {
  std::string bytes;
  for (const std::int32_t size : {1, 1, 1, 1}) put(bytes, size);
  for (const double coefficient : {1.0, 0.0, 1.0}) put(bytes, coefficient);
  return bytes;
}

std::string vega_matrix() {
  std::string bytes;
  for (const std::int32_t size : {3, 1}) put(bytes, size);
  for (const double number : {1.0, 0.0, 0.5}) put(bytes, number);
  return bytes;
}

constexpr std::size_t kReducedHeader = 32;  // its body follows

std::uint64_t fnv1a_of(const std::string& bytes, std::size_t begin) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t k = begin; k < bytes.size(); ++k) {
    hash = (hash ^ static_cast<unsigned char>(bytes[k])) * 0x100000001b3u;
  }
  return hash;
}

/// With the size and the checksum that belong to its body: without, all ends there.
std::string with_checksum(std::string bytes) {
  if (bytes.size() < kReducedHeader) return bytes;
  const std::uint64_t size = bytes.size() - kReducedHeader;
  const std::uint64_t sum = fnv1a_of(bytes, kReducedHeader);
  std::memcpy(&bytes[16], &size, sizeof(size));
  std::memcpy(&bytes[24], &sum, sizeof(sum));
  return bytes;
}

/// One tetrahedron, one coordinate that moves a vertex.
std::string reduced_model() {
  ReducedModel model;
  model.name = "t";
  model.material = {1e5, 0.3, 1000.0};
  model.modes = 1;
  model.mesh.vertices.resize(3, 4);
  model.mesh.vertices << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  model.mesh.tetrahedra.resize(4, 1);
  model.mesh.tetrahedra << 0, 1, 2, 3;
  model.fixed = {true, true, true, false};
  model.basis = Eigen::MatrixXd::Zero(12, 1);
  model.basis(9, 0) = 1.0;
  const std::vector<double> coefficients(
      static_cast<std::size_t>(QuarticPotential::coefficient_count(1)), 1.0);
  model.potential = QuarticPotential(Eigen::VectorXd::Ones(1), coefficients, "seed");
  return written("seed.prm", [&](const std::string& path) { write_reduced_model(path, model); });
}

const ColliderKey& seed_key() {
  static const ColliderKey key = collider_key("seed", 1.0, 1.0, 1.0, {});
  return key;
}

/// The only file of the cache's folder.
std::string cached_file() {
  return std::filesystem::directory_iterator(folder().path("cache"))->path().string();
}

std::string cached_collider() {
  std::string problem;
  ColliderCache(folder().path("cache")).write(seed_key(), make_mesh_collider(box()), problem);
  return bytes_of(cached_file());
}

// ---- readers of more than one file --------------------------------------------------------------

/// The two files of TetGen, which a byte 1 separates.
void read_tetgen_pair(const std::string& bytes) {
  const std::size_t cut = std::min(bytes.find('\x01'), bytes.size());
  const std::string path = folder().write("pair.node", bytes.substr(0, cut));
  folder().write("pair.ele", cut < bytes.size() ? bytes.substr(cut + 1) : "");
  read_tetrahedral_mesh(path);
}

void read_scene_text(const std::string& text) {
  const std::string path = write_scene(folder(), kFullScene);
  SceneSpec spec = read_scene(path, nullptr, {}, &text);
  double vertices = 0.0;
  for (const BodySpec& body : spec.bodies) {
    if (body.geometry.grid) {
      vertices += static_cast<double>(body.geometry.grid->columns) * body.geometry.grid->rows;
    } else {
      vertices += kMostVertices;  // what it takes depends on more than one number
    }
  }
  if (vertices < kMostVertices) build_world(spec);
}

void read_table(const std::string& path) {
  SceneTable table(path);
  for (std::size_t row = 0; row < table.size(); ++row) table.next();
}

/// With the hash of what stands before it: without, all ends there.
std::string with_hash(std::string bytes) {
  std::uint64_t hash = 0;
  if (bytes.size() < sizeof(hash)) return bytes;
  hash = XXH3_64bits(bytes.data(), bytes.size() - sizeof(hash));
  std::memcpy(&bytes[bytes.size() - sizeof(hash)], &hash, sizeof(hash));
  return bytes;
}

void read_cached(const std::string& bytes) {
  static const std::string path = cached_file();
  std::ofstream(path, std::ios::binary) << with_hash(bytes);
  std::string problem;
  if (!ColliderCache(folder().path("cache")).read(seed_key(), problem)) throw InputError("broken");
}

// ---- states of a running scene ----------------------------------------------------------------

/// Of everything that keeps numbers from step to step.
constexpr const char* kSavedScene = R"(time_step: 0.005
bodies:
  - name: cloth
    model: cloth
    geometry: {grid: {size: [0.2, 0.2], vertices: [3, 3]}}
    position: [0, 0, 0.001]
    attachments:
      - {name: pin, sphere: {center: [0.1, 0.1, 0], radius: 0.01}, to: world, stiffness: 100}
  - name: box
    model: rigid
    geometry: {box: {size: [0.1, 0.1, 0.1]}}
    position: [0, 0, 0.053]
  - name: beam
    model: reduced
    geometry: {example: {name: beam, scale: 0.1, rank: 2, modes: 2}}
    position: [1, 0, 0.05]
  - name: blob
    model: viscoelastic
    geometry: {block: {size: [0.03, 0.03, 0.03]}, spacing: 0.01}
    position: [2, 0, 0.02]
    material: {state: viscoelastic, beta: 0.5}
obstacles:
  - {name: floor, shape: plane}
effects:
  gravity: {}
  contact: {thickness: 0.002}
  friction: {coefficient: 0.5}
  wetness: {wetness: 0.5}
  air: {volume: 1.0e-6}
  body_contact: {thickness: 0.002}
)";

World& saved_world() {
  SceneOverrides overrides;
  overrides.text = kSavedScene;
  static const LoadedScene scene = load_scene("state.yaml", overrides);
  return *scene.world;
}

std::string saved_state() {
  World& world = saved_world();
  for (int k = 0; k < 3; ++k) world.step();
  return state_bytes({world.save(), {{0.1, 0.2}}});
}

/// With the hash that its first line is followed by.
std::string with_state_hash(std::string bytes) {
  const std::size_t line = bytes.find('\n') + 1;
  std::uint64_t hash = 0;
  if (line == 0 || bytes.size() < line + sizeof(hash)) return bytes;
  const std::size_t begin = line + sizeof(hash);
  hash = XXH3_64bits(bytes.data() + begin, bytes.size() - begin);
  std::memcpy(&bytes[line], &hash, sizeof(hash));
  return bytes;
}

/// What can be loaded is stepped from, too.
void load_saved(const std::string& bytes) {
  World& world = saved_world();
  world.load(state_of(with_state_hash(bytes), "state").checkpoint);
  world.step();
}

std::string stl_text() {
  return "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
         "endloop\nendfacet\nendsolid s\n";
}

std::string ply_text() {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
}

void put_chunk(std::string& bytes, const std::string& kind, std::string content) {
  while (content.size() % 4 != 0) content += ' ';
  put(bytes, static_cast<std::uint32_t>(content.size()));
  bytes += kind + content;
}

/// As kGltf, with its numbers in a chunk of the file.
std::string glb() {
  std::string json = kGltf;
  const std::size_t uri = json.find(", \"uri\"");
  json.erase(uri, json.find('}', uri) - uri);
  std::string numbers;
  for (const std::uint16_t index : {0, 1, 2, 0}) put(numbers, index);
  for (const float x : {0, 0, 0, 1, 0, 0, 0, 1, 0}) put(numbers, x);
  std::string chunks;
  put_chunk(chunks, "JSON", json);
  put_chunk(chunks, std::string("BIN\0", 4), numbers);
  std::string bytes = "glTF";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(12 + chunks.size()));
  return bytes + chunks;
}

std::vector<FuzzTarget> make_targets() {
  std::vector<FuzzTarget> all;
  all.push_back(target("scene", {kFullScene}, read_scene_text));
  all.push_back(
      target("urdf", {kLiftUrdf}, [](const std::string& text) { Robot::from_text(text); }));
  all.push_back(file_target("keyframes", "yaml", {kLiftMotion}, [](const std::string& path) {
    make_keyframes(read_keyframe_file(path), nullptr);
  }));
  all.push_back(target("patch", {bytes_of(PLIANT_SOURCE_DIR "/config/patches/three_patches.yaml")},
                       [](const std::string& text) { parse_patch_body(text, "f.yaml"); }));
  all.push_back(
      mesh("obj", {"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n"}));
  all.push_back(mesh("stl", {stl_text(), binary_stl(box())}));
  all.push_back(mesh("ply", {ply_text(), written("seed.ply", [](const std::string& path) {
                               write_ply(path, box());
                             })}));
  all.push_back(mesh("gltf", {kGltf}));
  all.push_back(mesh("glb", {glb()}));
  all.push_back(mesh("dae", {collada("Z_UP")}));
  all.push_back(file_target("gmsh", "msh", {tetrahedra_text(false), kGmsh22},
                            [](const std::string& path) { read_tetrahedral_mesh(path); }));
  all.push_back(
      file_target("veg", "veg", {kVeg, "*INCLUDE part.veg\n"}, [](const std::string& path) {
        folder().write("part.veg", kVeg);
        read_tetrahedral_mesh(path);
      }));
  all.push_back(target("tetgen", {tetrahedra_text(true)}, read_tetgen_pair));
  all.push_back(
      file_target("cub", "cub", {cub()}, [](const std::string& path) { read_cub(path); }));
  all.push_back(file_target("vega_matrix", "U", {vega_matrix()},
                            [](const std::string& path) { read_vega_matrix(path); }));
  all.push_back(target("reduced_model", {reduced_model()}, [](const std::string& bytes) {
    read_reduced_model(folder().write("input.prm", with_checksum(bytes)));
  }));
  all.push_back(target("collider_cache", {cached_collider()}, read_cached));
  all.push_back(file_target("scene_table", "csv",
                            {"limits.max_speed,bodies[0].velocity\n1000,\"[0, 0, 0]\"\n10,1\n"},
                            read_table));
  all.push_back(target("state", {saved_state()}, load_saved));
  AccuracyRow row;
  row.solver = "xpbd";
  all.push_back(target("accuracy_table", {to_csv({row})},
                       [](const std::string& text) { rows_from_csv(text, "a.csv"); }));
  return all;
}

}  // namespace

const std::vector<FuzzTarget>& fuzz_targets() {
  static const std::vector<FuzzTarget> all = make_targets();
  return all;
}

}  // namespace pliant
