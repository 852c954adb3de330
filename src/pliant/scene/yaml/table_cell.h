#pragma once

#include <string>

namespace pliant {

/// A text as a cell of a CSV table: quoted where it holds what ends a cell or a row.
inline std::string table_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace pliant
