#include "pliant/study/judges/strip_elastica.h"

#include <cmath>

namespace pliant {
namespace {

struct StripEnd {
  StripTip tip;
  double rate = 0.0;  // θ'(L)
};

/// Classical Runge-Kutta steps from the clamp on, in units of (B/w)^(1/3).
StripEnd shoot(double length, double rate) {
  constexpr int kSteps = 2000;
  const double h = length / kSteps;
  const auto f = [&](double s, double theta) { return -(length - s) * std::cos(theta); };
  StripEnd end;
  double theta = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double s = k * h;
    const double k1 = rate, l1 = f(s, theta);
    const double k2 = rate + 0.5 * h * l1, l2 = f(s + 0.5 * h, theta + 0.5 * h * k1);
    const double k3 = rate + 0.5 * h * l2, l3 = f(s + 0.5 * h, theta + 0.5 * h * k2);
    const double k4 = rate + h * l3, l4 = f(s + h, theta + h * k3);
    const double next = theta + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    // Simpson's rule with the middle of a cubic.
    const double middle = 0.5 * (theta + next) + 0.125 * h * (k1 - k4);
    end.tip.along += h / 6.0 * (std::cos(theta) + 4.0 * std::cos(middle) + std::cos(next));
    end.tip.below += h / 6.0 * (std::sin(theta) + 4.0 * std::sin(middle) + std::sin(next));
    theta = next;
    rate += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
  }
  end.rate = rate;
  return end;
}

}  // namespace

StripTip elastica_tip(double length) {
  // θ'(L) rises with θ'(0).
  double low = 0.0, high = length * length;
  StripEnd end;
  for (int n = 0; n < 60; ++n) {
    const double middle = 0.5 * (low + high);
    end = shoot(length, middle);
    (end.rate > 0.0 ? high : low) = middle;
  }
  return end.tip;
}

double elastica_chord_angle(double length) {
  const StripTip tip = elastica_tip(length);
  return std::atan2(tip.below, tip.along);
}

double elastica_overhang(double angle) {
  double low = 0.1, high = 8.0;
  for (int n = 0; n < 50; ++n) {
    const double middle = 0.5 * (low + high);
    (elastica_chord_angle(middle) > angle ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace pliant
