#include "pliant/app/batch/batch_hash.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <fstream>

#include "pliant/math/error.h"
#include "pliant/math/version.h"
#include "pliant/study/study_settings.h"

namespace pliant {

std::string batch_hash(const SceneSpec& scene, const std::string& table,
                       const std::string& settings) {
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  std::string text =
      fmt::format("{} {:016x} {} {}", kVersion, scene_hash(scene), settings, scene.solver.name);
  for (const auto& [name, value] : scene.solver.parameters) text += " " + name + "=" + value;
  XXH3_128bits_update(&state, text.data(), text.size());
  if (!table.empty()) {
    std::ifstream file(table, std::ios::binary);
    std::array<char, 1 << 16> bytes = {};
    while (file.read(bytes.data(), bytes.size()) || file.gcount() > 0) {
      XXH3_128bits_update(&state, bytes.data(), static_cast<std::size_t>(file.gcount()));
    }
    if (!file.eof()) throw InputError(table + ": cannot be read");
  }
  const XXH128_hash_t hash = XXH3_128bits_digest(&state);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace pliant
