#include "pliant/geometry/io/readable_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "pliant/math/error.h"

namespace pliant {

std::string checked_extension(const std::string& path, const std::vector<std::string>& allowed) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw InputError(fmt::format("mesh '{}': no such file", path));
  }
  if (!std::filesystem::is_regular_file(path, error)) {
    throw InputError(fmt::format("mesh '{}': not a file", path));
  }
  if (!std::ifstream(path).good()) throw InputError(fmt::format("mesh '{}': cannot be read", path));
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (std::find(allowed.begin(), allowed.end(), extension) != allowed.end()) return extension;
  throw InputError(fmt::format("mesh '{}': {}", path,
                               unknown_name_message("file extension", extension, allowed)));
}

std::string why_no_part(const std::string& path, const std::string& part) {
  namespace fs = std::filesystem;
  // As they are written: links within the folder are the user's own.
  const fs::path folder = fs::absolute(path).lexically_normal().parent_path();
  const fs::path within = fs::absolute(part).lexically_normal().lexically_relative(folder);
  if (within.empty() || *within.begin() == "..") return "is outside of the mesh's folder";
  std::error_code error;
  if (!fs::exists(part, error)) return "is not there";
  return fs::is_regular_file(part, error) ? "" : "is no regular file";
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes;
  char block[1 << 16];
  while (file.read(block, sizeof(block)) || file.gcount() > 0) {
    bytes.append(block, static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad() || !file.is_open()) {
    throw InputError(fmt::format("mesh '{}': cannot be read", path));
  }
  return bytes;
}

}  // namespace pliant
