#include "pliant/geometry/io/included_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "pliant/geometry/io/readable_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr std::string_view kSpaces = " \t\r\v\f";
constexpr std::string_view kInclude = "*INCLUDE";

std::string_view trimmed(std::string_view text) {
  text = text.substr(0, text.find('#'));
  const std::size_t first = text.find_first_not_of(kSpaces);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpaces) - first + 1);
}

}  // namespace

IncludedLines::IncludedLines(std::string path, std::string bytes) : path_(path) {
  files_.push_back({std::move(path), std::move(bytes)});
}

bool IncludedLines::next() {
  if (std::exchange(is_held_, false)) return true;
  while (!files_.empty()) {
    File& file = files_.back();
    if (file.at >= file.bytes.size()) {
      files_.pop_back();
      continue;
    }
    const std::size_t end = std::min(file.bytes.find('\n', file.at), file.bytes.size());
    line_ = trimmed(std::string_view(file.bytes).substr(file.at, end - file.at));
    file.at = end + 1;
    path_ = file.path;
    number_ = ++file.number;
    if (line_.compare(0, kInclude.size(), kInclude) == 0) {
      include(trimmed(std::string_view(line_).substr(kInclude.size())));
    } else if (!line_.empty()) {
      return true;
    }
  }
  return false;
}

void IncludedLines::include(std::string_view name) {
  if (name.empty()) fail("*INCLUDE names no file");
  if (++includes_ > kMaxIncludes) fail(fmt::format("more than {} files included", kMaxIncludes));
  namespace fs = std::filesystem;
  const std::string part = (fs::path(path_).parent_path() / name).lexically_normal().string();
  const std::string why = why_no_part(path_, part);
  if (!why.empty()) fail(fmt::format("the included file '{}' {}", name, why));
  std::error_code error;
  for (const File& file : files_) {
    if (fs::equivalent(file.path, part, error)) {
      fail(fmt::format("the included file '{}' includes itself", name));
    }
  }
  files_.push_back({part, read_bytes(part)});
}

void IncludedLines::fail(const std::string& what) const {
  throw InputError(fmt::format("mesh '{}', line {}: {}", path_, number_, what));
}

}  // namespace pliant
