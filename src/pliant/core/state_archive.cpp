#include "pliant/core/state_archive.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "pliant/math/error.h"

namespace pliant {

double StateArchive::read() {
  return next_ < values_.size() ? values_[next_++] : std::numeric_limits<double>::quiet_NaN();
}

std::int64_t StateArchive::read_whole(std::int64_t least, std::int64_t most) {
  const double value = read();
  if (value >= static_cast<double>(least) && value <= static_cast<double>(most) &&
      value == std::floor(value)) {
    return static_cast<std::int64_t>(value);
  }
  throw InputError(
      fmt::format("the saved state is damaged or of another scene: it has {} where a whole number "
                  "from {} to {} belongs",
                  value, least, most));
}

int StateArchive::read_int() {
  using Limits = std::numeric_limits<int>;
  return static_cast<int>(read_whole(Limits::min(), Limits::max()));
}

std::size_t StateArchive::read_count(std::size_t numbers) {
  const std::size_t most = left() > 0 ? (left() - 1) / numbers : 0;
  return static_cast<std::size_t>(read_whole(0, static_cast<std::int64_t>(most)));
}

}  // namespace pliant
