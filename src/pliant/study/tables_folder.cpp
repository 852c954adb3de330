#include "pliant/study/tables_folder.h"

#include <fmt/format.h>

#include <filesystem>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/readable_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

/// A table or a picture in `folder`; empty where there is none.
std::string result_in(const std::string& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".csv" || extension == ".png" || extension == ".svg") {
      return entry.path().string();
    }
  }
  return "";
}

}  // namespace

void claim_tables_folder(const std::string& folder, const std::string& study) {
  const std::string mark = folder + "/study.yaml";
  const std::string text = fmt::format(
      "# `pliant study {0}` replaces its tables and pictures here.\nstudy: {0}\n", study);
  try {
    fs::create_directories(folder);
    if (fs::is_regular_file(fs::symlink_status(mark)) && read_bytes(mark) == text) return;
    const std::string other = fs::exists(fs::symlink_status(mark)) ? mark : result_in(folder);
    if (!other.empty()) {
      throw InputError(fmt::format(
          "'{}' is there and was not written by `pliant study {}`: choose another --out, "
          "or move it away",
          other, study));
    }
    write_file_atomically(mark, text);
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("cannot make folder '{}': {}", folder, error.code().message()));
  }
}

}  // namespace pliant
