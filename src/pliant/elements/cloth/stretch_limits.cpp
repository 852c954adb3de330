#include "pliant/elements/cloth/stretch_limits.h"

#include <fmt/format.h>

#include "pliant/math/error.h"

namespace pliant {

void check(const std::string& name, const StretchLimits& limits) {
  if (limits.min > 0.0 && limits.min <= 1.0 && limits.max >= 1.0) return;
  throw InputError(fmt::format("{}: stretch limits {} to {}; needs 0 < min <= 1 <= max", name,
                               limits.min, limits.max));
}

}  // namespace pliant
