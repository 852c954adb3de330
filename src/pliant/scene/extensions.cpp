#include "pliant/scene/extensions.h"

#include <fmt/format.h>

#include <cstdlib>
#include <mutex>
#include <set>
#include <sstream>

#include "pliant/math/error.h"
#include "pliant/math/loaded_library.h"

namespace pliant {
namespace {

constexpr const char* kVariable = "PLIANT_EXTENSIONS";

std::set<std::string>& loaded() {
  static std::set<std::string> files;
  return files;
}

void load_all_of(const char* value) {
  if (value == nullptr) return;
  std::istringstream files(value);
  for (std::string file; std::getline(files, file, ':');) {
    if (file.empty()) continue;
    try {
      load_extension(file);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", kVariable, error.what()));
    }
  }
}

}  // namespace

void load_extension(const std::string& file) {
  // A relative one might be whatever lies in the working directory.
  if (file.empty() || file.front() != '/') {
    throw InputError(fmt::format("extension '{}': write an absolute path", file));
  }
  if (loaded().count(file) > 0) return;
  LoadedLibrary library(file.c_str());
  using Version = const char*();
  using Extend = void();
  auto* version = library.find<Version>("pliant_extension_version");
  auto* extend = library.find<Extend>("pliant_extend");
  if (version == nullptr || extend == nullptr) {
    throw InputError(
        fmt::format("extension '{}': {}; it needs a PLIANT_EXTENSION "
                    "(docs/library.md)",
                    file, library.why_not()));
  }
  if (version() != std::string(kVersion)) {
    throw InputError(
        fmt::format("extension '{}' was built for Pliant {}, and this is {}: build it "
                    "anew",
                    file, version(), kVersion));
  }
  extend();
  loaded().insert(file);
}

void load_extensions_of_environment() {
  // Where one fails, whoever asks next hears of it, too.
  static std::once_flag are_loaded;
  std::call_once(are_loaded, load_all_of, std::getenv(kVariable));
}

}  // namespace pliant
