#include "pliant/scene/yaml/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "pliant/math/error.h"

namespace pliant {
namespace {

/// Bytes of the UTF-8 character that begins at `i`; 0 when there is none.
std::size_t utf8_length(const std::string& text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(i);
  if (first < 0x80) return first == 0 ? 0 : 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || i + length > text.size()) return 0;
  for (std::size_t k = i + 1; k < i + length; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return 0;
  }
  return length;
}

}  // namespace

std::ifstream open_text_file(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw InputError(path + ": there is no such file");
  if (!std::filesystem::is_regular_file(status)) throw InputError(path + ": this is not a file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw InputError(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  }
  return stream;
}

std::string read_text_file(const std::string& path, std::size_t max_bytes) {
  std::ifstream stream = open_text_file(path);
  std::string text;
  char block[1 << 14];
  while (text.size() <= max_bytes && (stream.read(block, sizeof(block)) || stream.gcount() > 0)) {
    text.append(block, static_cast<std::size_t>(stream.gcount()));
  }
  if (text.size() > max_bytes) {
    throw InputError(fmt::format("{}: the file is longer than {} bytes", path, max_bytes));
  }
  return text;
}

void check_text(const std::string& text, const std::string& file, int line) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    if (length == 0) {
      throw InputError(
          fmt::format("{}:{}: this is not text (byte {} is no UTF-8 character)", file, line, i));
    }
    if (text[i] == '\n') ++line;
    i += length;
  }
}

}  // namespace pliant
