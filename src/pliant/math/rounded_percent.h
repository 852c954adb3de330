#pragma once

namespace pliant {

/// A share in percent, in steps of two to two and a half from 5 to 200, so that the warnings of a
/// run differ little.
inline int rounded_percent(double share) {
  constexpr int kSteps[] = {5, 10, 20, 50, 100};
  for (const int percent : kSteps) {
    if (share < 0.015 * percent) return percent;
  }
  return 200;
}

}  // namespace pliant
