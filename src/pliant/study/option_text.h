#pragma once

#include <string>
#include <vector>

namespace pliant {

// Options of a study as a user writes them. Each function throws InputError that begins with
// `option` ("--iterations") and says what to write instead.

/// "a,b": names, none empty or twice. "all" is the empty list.
std::vector<std::string> parse_names(const std::string& text, const std::string& option);

/// "1,2,4": whole numbers from 1 to 1e6, none twice; sorted.
std::vector<int> parse_counts(const std::string& text, const std::string& option);

/// "0.005,0.0025": numbers > 0 and <= 1 [s], none twice; the largest first.
std::vector<double> parse_time_steps(const std::string& text, const std::string& option);

/// "16ms", "0.016s" or "500us" -> seconds; > 0.
double parse_wall_time(const std::string& text, const std::string& option);

}  // namespace pliant
