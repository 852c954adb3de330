// Part of every test program: what tests keep in a cache vanishes with them, and no test finds what
// an earlier build has kept.
#include <stdlib.h>

#include <filesystem>
#include <string>

namespace {

class TemporaryCache {
 public:
  TemporaryCache() {
    std::string pattern = (std::filesystem::temp_directory_path() / "pliant_cache_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) return;
    folder_ = pattern;
    setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
  }
  ~TemporaryCache() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }

 private:
  std::string folder_;
};

const TemporaryCache cache;

}  // namespace
