#include "pliant/solvers/checks/error_control.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {
// Of the asked error: below it, fewer iterations are tried.
constexpr double kFarBelow = 0.25;
// By how much at a time.
constexpr double kLeastMore = 1.25, kMostMore = 2.0, kFewer = 0.8;
}  // namespace

void ErrorControl::learn(double error, int iterations) {
  if (!is_on()) return;
  double factor = 1.0;
  // Errors of iterations without acceleration fall slowly: as many more as the error is too large.
  if (error > asked_.error) factor = std::clamp(error / asked_.error, kLeastMore, kMostMore);
  if (error < kFarBelow * asked_.error) factor = kFewer;
  const double next =
      factor > 1.0 ? std::ceil(factor * iterations) : std::floor(factor * iterations);
  present_.iterations = static_cast<int>(std::clamp(next, 1.0, double(asked_.most_iterations)));
}

void ErrorControl::load(StateArchive& numbers) {
  const double iterations = numbers.read();
  if (is_on() && iterations >= 1.0) present_.iterations = static_cast<int>(iterations);
}

}  // namespace pliant
