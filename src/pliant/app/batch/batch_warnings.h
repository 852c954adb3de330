#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>

namespace pliant {

/// What steps of a batch's scenes warned of, each once a scene: a table, so that what was told
/// before an interruption, or in another shard, is known at the end.
constexpr const char* kWarningTable = "warnings.csv";
constexpr const char* kWarningHeader = "scene,warning\n";

std::string warning_rows(std::size_t scene, const std::set<std::string>& warnings);
/// How many scenes of the table `bytes` have each warning, added to `counts`.
void count_warnings(const std::string& bytes, std::map<std::string, int>& counts);

}  // namespace pliant
