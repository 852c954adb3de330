#include "pliant/geometry/repair/collider_cache.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Raise it with every change of what colliders are made of a mesh: it is part of every key.
constexpr std::uint32_t kColliderVersion = 3;

constexpr char kMagic[8] = {'p', 'l', 'i', 'a', 'n', 't', 'c', '1'};
constexpr const char* kExtension = ".collider";

/// Appends numbers as this machine keeps them: the cache does not leave it.
class ByteWriter {
 public:
  template <class T>
  void add(const T& value) {
    add(&value, 1);
  }
  template <class T>
  void add(const T* values, std::size_t count) {
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  bool take(T* values, std::size_t count) {
    if (count > bytes_.size() / sizeof(T)) return false;
    if (count == 0) return true;  // then there may be no values to point to
    std::memcpy(values, bytes_.data(), count * sizeof(T));
    bytes_.remove_prefix(count * sizeof(T));
    return true;
  }
  template <class T>
  bool take(T& value) {
    return take(&value, 1);
  }
  /// Whether so many of this size may still come.
  template <class T>
  bool holds(std::uint64_t count) const {
    return count <= bytes_.size() / sizeof(T);
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

std::string to_bytes(const ColliderKey& key, const MeshCollider& collider) {
  const TriangleMesh surface = collider.shape->surface();
  const DistanceGrid& grid = collider.shape->grid();
  ByteWriter file;
  file.add(kMagic, sizeof(kMagic));
  file.add(key);
  file.add(static_cast<std::int32_t>(collider.kind));
  file.add(static_cast<std::uint64_t>(collider.note.size()));
  file.add(collider.note.data(), collider.note.size());
  file.add(static_cast<std::uint64_t>(surface.vertices.cols()));
  file.add(surface.vertices.data(), static_cast<std::size_t>(surface.vertices.size()));
  file.add(static_cast<std::uint64_t>(surface.triangles.cols()));
  file.add(surface.triangles.data(), static_cast<std::size_t>(surface.triangles.size()));
  file.add(grid.origin.data(), 3);
  file.add(grid.spacing);
  file.add(grid.count.data(), 3);
  file.add(grid.samples.data(), grid.samples.size());
  file.add(static_cast<std::uint64_t>(XXH3_64bits(file.bytes().data(), file.bytes().size())));
  return file.bytes();
}

bool take_surface(ByteReader& file, TriangleMesh& surface) {
  std::uint64_t vertices = 0, triangles = 0;
  if (!file.take(vertices) || !file.holds<double[3]>(vertices)) return false;
  surface.vertices.resize(3, static_cast<Eigen::Index>(vertices));
  file.take(surface.vertices.data(), 3 * vertices);
  if (!file.take(triangles) || !file.holds<int[3]>(triangles)) return false;
  surface.triangles.resize(3, static_cast<Eigen::Index>(triangles));
  if (!file.take(surface.triangles.data(), 3 * triangles)) return false;
  return vertices > 0 && surface.vertices.allFinite() && (surface.triangles.array() >= 0).all() &&
         (surface.triangles.array() < static_cast<int>(vertices)).all();
}

bool take_grid(ByteReader& file, DistanceGrid& grid) {
  if (!file.take(grid.origin.data(), 3) || !file.take(grid.spacing) ||
      !file.take(grid.count.data(), 3)) {
    return false;
  }
  if (!grid.origin.allFinite() || !std::isfinite(grid.spacing) || !(grid.spacing > 0.0)) {
    return false;
  }
  if ((grid.count < 2).any() || grid.count.cast<double>().prod() > 1e9) return false;
  const auto samples = static_cast<std::uint64_t>(grid.count.cast<std::int64_t>().prod());
  if (!file.holds<float>(samples)) return false;
  grid.samples.resize(samples);
  return file.take(grid.samples.data(), samples);
}

/// Nothing for bytes that are not whole.
std::optional<MeshCollider> from_bytes(std::string_view bytes, const ColliderKey& key) {
  std::uint64_t sum = 0;
  if (bytes.size() < sizeof(sum)) return std::nullopt;
  std::memcpy(&sum, bytes.data() + bytes.size() - sizeof(sum), sizeof(sum));
  bytes.remove_suffix(sizeof(sum));
  if (sum != XXH3_64bits(bytes.data(), bytes.size())) return std::nullopt;
  ByteReader file(bytes);
  char magic[sizeof(kMagic)];
  ColliderKey own;
  std::int32_t kind = 0;
  std::uint64_t length = 0;
  MeshCollider collider;
  if (!file.take(magic, sizeof(magic)) || std::memcmp(magic, kMagic, sizeof(magic)) != 0 ||
      !file.take(own) || own != key || !file.take(kind) || kind < 0 ||
      kind > static_cast<std::int32_t>(ColliderKind::kThickShell) || !file.take(length) ||
      !file.holds<char>(length)) {
    return std::nullopt;
  }
  collider.kind = static_cast<ColliderKind>(kind);
  collider.note.resize(length);
  file.take(collider.note.data(), length);
  TriangleMesh surface;
  DistanceGrid grid;
  if (!take_surface(file, surface) || !take_grid(file, grid) || !file.at_end()) {
    return std::nullopt;
  }
  try {
    collider.shape = std::make_shared<MeshShape>(std::move(surface), std::move(grid));
  } catch (const InputError&) {
    return std::nullopt;
  }
  return collider;
}

std::string usual_folder() {
  const auto absolute = [](const char* name) -> fs::path {
    const char* value = std::getenv(name);
    const fs::path path = value == nullptr ? "" : value;
    return path.is_absolute() ? path : fs::path();
  };
  if (const fs::path cache = absolute("XDG_CACHE_HOME"); !cache.empty()) {
    return (cache / "pliant").string();
  }
  const fs::path home = absolute("HOME");
  return home.empty() ? "" : (home / ".cache" / "pliant").string();
}

}  // namespace

ColliderKey collider_key(std::string_view mesh, double scale_x, double scale_y, double scale_z,
                         const ColliderOptions& options) {
  ByteWriter rest;
  const XXH128_hash_t content = XXH3_128bits(mesh.data(), mesh.size());
  rest.add(kColliderVersion);
  rest.add(content.low64);
  rest.add(content.high64);
  for (const double number : {scale_x, scale_y, scale_z, options.voxel_size, options.thickness}) {
    rest.add(number);
  }
  rest.add(static_cast<std::int32_t>(options.kind));
  const XXH128_hash_t all = XXH3_128bits(rest.bytes().data(), rest.bytes().size());
  return {all.low64, all.high64};
}

ColliderCache::ColliderCache() : ColliderCache(usual_folder()) {}

ColliderCache::ColliderCache(std::string folder, std::uint64_t most_bytes)
    : folder_(std::move(folder)), most_bytes_(most_bytes) {}

std::string ColliderCache::path(const ColliderKey& key) const {
  return (fs::path(folder_) / fmt::format("{:016x}{:016x}{}", key[1], key[0], kExtension)).string();
}

std::optional<MeshCollider> ColliderCache::read(const ColliderKey& key,
                                                std::string& problem) const {
  if (folder_.empty()) return std::nullopt;
  const std::string name = path(key);
  std::error_code ignored;
  if (!fs::is_regular_file(name, ignored)) return std::nullopt;
  std::ifstream stream(name, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)),
                          std::istreambuf_iterator<char>());
  std::optional<MeshCollider> collider = from_bytes(bytes, key);
  if (!collider) {
    problem = fmt::format("'{}' in the cache was broken and was made anew", name);
    return std::nullopt;
  }
  // What was used last is kept the longest.
  fs::last_write_time(name, fs::file_time_type::clock::now(), ignored);
  return collider;
}

void ColliderCache::write(const ColliderKey& key, const MeshCollider& collider,
                          std::string& problem) const {
  if (folder_.empty()) return;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    problem = fmt::format("nothing is kept in the cache: cannot make the folder '{}': {}", folder_,
                          error.message());
    return;
  }
  try {
    write_file_atomically(path(key), to_bytes(key, collider));
    remove_oldest();
  } catch (const InputError& failure) {
    problem = fmt::format("nothing is kept in the cache: {}", failure.what());
  }
}

void ColliderCache::remove_oldest() const {
  struct File {
    fs::file_time_type used;
    std::uint64_t bytes;
    fs::path path;
  };
  std::vector<File> files;
  std::uint64_t sum = 0;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
    if (entry.path().extension() != kExtension) continue;
    const File file = {entry.last_write_time(error), entry.file_size(error), entry.path()};
    if (error) continue;  // another process has just removed it
    files.push_back(file);
    sum += file.bytes;
  }
  std::sort(files.begin(), files.end(),
            [](const File& a, const File& b) { return a.used < b.used; });
  for (std::size_t k = 0; k + 1 < files.size() && sum > most_bytes_; ++k) {
    fs::remove(files[k].path, error);
    sum -= files[k].bytes;
  }
}

}  // namespace pliant
