#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// Where a value of a JSON text stands: in an object under a key, in an array under a number.
struct JsonLevel {
  std::string_view key;  ///< as it is written, between its quotes; empty in an array
  int index = -1;        ///< in an array
};

/// Calls visit(levels, value) for each text, number and literal of a JSON text, in order, and for
/// each object and array as it begins, with the value `{` or `[`; a text comes without its quotes.
/// A null character ends the text. Returns an empty string, or what is wrong: not JSON (where a
/// strict reader would stop too), nested deeper than `most_levels`, or a key with an escape.
std::string walk_json(
    std::string_view text, std::size_t most_levels,
    const std::function<void(const std::vector<JsonLevel>&, std::string_view)>& visit);

}  // namespace pliant
