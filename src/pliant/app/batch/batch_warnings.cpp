#include "pliant/app/batch/batch_warnings.h"

#include "pliant/scene/yaml/table_cell.h"

namespace pliant {
namespace {

/// The cell that begins at `at`, out of its quotes; `at` is then behind the row's end.
std::string last_cell(const std::string& bytes, std::size_t& at) {
  const bool is_quoted = at < bytes.size() && bytes[at] == '"';
  std::string cell;
  for (at += is_quoted ? 1 : 0; at < bytes.size(); ++at) {
    if (is_quoted && bytes[at] == '"' && bytes[++at] != '"') break;
    if (!is_quoted && bytes[at] == '\n') break;
    cell += bytes[at];
  }
  ++at;
  return cell;
}

}  // namespace

std::string warning_rows(std::size_t scene, const std::set<std::string>& warnings) {
  std::string rows;
  for (const std::string& warning : warnings) {
    rows += std::to_string(scene) + "," + table_cell(warning) + "\n";
  }
  return rows;
}

void count_warnings(const std::string& bytes, std::map<std::string, int>& counts) {
  for (std::size_t at = bytes.find('\n') + 1; at < bytes.size();) {
    at = bytes.find(',', at) + 1;
    ++counts[last_cell(bytes, at)];
  }
}

}  // namespace pliant
