#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "pliant/geometry/io/readable_file.h"
#include "pliant/geometry/mesh_checks/json_walk.h"
#include "pliant/geometry/mesh_checks/mesh_checks.h"
#include "pliant/geometry/mesh_checks/node_graph.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr std::size_t kMostLevels = 64;
constexpr std::size_t kHeaderBytes = 20;  // of a binary file: its own, and that of its first chunk

/// What is written there, little-endian.
std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t k = 4; k-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[at + k]);
  return word;
}

class Check {
 public:
  Check(const std::string& path, std::size_t bytes) : path_(path), held_(double(bytes)) {}

  void run(std::string_view json) {
    const std::string wrong = walk_json(
        json, kMostLevels,
        [&](const std::vector<JsonLevel>& levels, std::string_view v) { look(levels, v); });
    if (!wrong.empty()) fail(wrong);
    // Texts and numbers that cannot be bytes of a file are left to assimp.
    for (const Announced& announced : announced_) {
      if (announced.number <= held_ && announced.number >= 0.0) continue;
      fail(fmt::format("{} is {:g}, but the file and its buffers hold {:g} bytes", announced.what,
                       announced.number, held_));
    }
    for (const auto& [parent, child] : children_) {
      const auto found = nodes_.find(child);
      if (found == nodes_.end()) continue;  // assimp says so
      if (!held_nodes_.insert(found->second).second)
        fail(fmt::format("node '{}' is held twice", child));
      graph_.add_child(nodes_.at(parent), found->second);
    }
    graph_.check(path_);
  }

 private:
  struct Announced {
    std::string what;
    double number;
  };

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("mesh '{}': {}", path_, what));
  }

  static std::string name_of(const JsonLevel& level) {
    return level.index >= 0 ? std::to_string(level.index) : std::string(level.key);
  }

  void look(const std::vector<JsonLevel>& levels, std::string_view value) {
    if (levels.size() < 2) return;
    const std::string_view top = levels[0].key;
    if (top == "nodes" && levels.size() == 2) {
      const std::string name = name_of(levels[1]);
      if (nodes_.emplace(name, graph_.size()).second) graph_.add(name);
    }
    if (top == "nodes" && levels.size() == 4 && levels[2].key == "children") {
      children_.emplace_back(name_of(levels[1]), value);
    }
    if (top == "buffers" && levels.size() == 3 && levels[2].key == "uri") add_buffer(value);
    if (top == "buffers" || top == "bufferViews" || top == "accessors") add_number(levels, value);
  }

  /// Sizes, counts and offsets, all of bytes that the files hold, or of what takes a byte at least.
  void add_number(const std::vector<JsonLevel>& levels, std::string_view value) {
    for (const JsonLevel& level : levels) {
      if (level.key == "extras" || level.key == "extensions") return;
    }
    const std::string_view key = levels.back().key;
    if (key != "byteLength" && key != "byteOffset" && key != "byteStride" && key != "count") return;
    double number = 0.0;
    const auto read = std::from_chars(value.data(), value.data() + value.size(), number);
    if (read.ec == std::errc::result_out_of_range) number = HUGE_VAL;
    announced_.push_back(
        {fmt::format("{} of {}[{}]", key, levels[0].key, name_of(levels[1])), number});
  }

  void add_buffer(std::string_view uri) {
    if (uri.rfind("data:", 0) == 0) return;
    const std::filesystem::path file =
        std::filesystem::path(path_).parent_path() / std::filesystem::path(std::string(uri));
    const std::string why = why_no_part(path_, file.string());
    if (!why.empty()) fail(fmt::format("its buffer '{}' {}", uri, why));
    held_ += static_cast<double>(std::filesystem::file_size(file));
  }

  const std::string& path_;
  double held_;
  NodeGraph graph_;
  std::map<std::string, int> nodes_;
  std::set<int> held_nodes_;
  std::vector<std::pair<std::string, std::string>> children_;
  std::vector<Announced> announced_;
};

/// The text of a binary file.
std::string_view first_chunk(const std::string& path, std::string_view bytes) {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("mesh '{}': {}", path, what));
  };
  if (bytes.size() < kHeaderBytes || bytes.substr(0, 4) != "glTF") fail("not a binary glTF file");
  const std::uint32_t length = word_at(bytes, 8), text = word_at(bytes, 12);
  if (length > bytes.size()) {
    fail(fmt::format("announces {} bytes, but has {}", length, bytes.size()));
  }
  if (length < kHeaderBytes || text > length - kHeaderBytes) {
    fail(fmt::format("its first chunk announces {} bytes, but the file has {}", text, length));
  }
  // Other chunks follow, each with its length and type before it.
  std::size_t next = kHeaderBytes + text;
  next += (4 - next % 4) % 4;
  while (word_at(bytes, 4) >= 2 && next + 8 <= length) {
    const std::uint32_t chunk = word_at(bytes, next);
    if (chunk > length - next - 8) {
      fail(fmt::format("a chunk announces {} bytes, but the file has {}", chunk, length));
    }
    next += 8 + std::size_t{chunk};
  }
  return bytes.substr(kHeaderBytes, text);
}

}  // namespace

void check_gltf(const std::string& path, std::string_view bytes, bool is_binary) {
  Check(path, bytes.size()).run(is_binary ? first_chunk(path, bytes) : bytes);
}

}  // namespace pliant
