#include "pliant/effects/air/bubble_pressure.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

constexpr int kMaxRootIterations = 60;
constexpr double kRelativeTolerance = 1e-10;
// V_0 / V of nearly a vacuum.
constexpr double kSmallShare = 1e-2;

struct Sample {
  double value;
  double slope;  // an estimate that is right near the root is enough
};

/// Root of the increasing function `f` above `lo`, by Newton steps from 0 kept inside the bracket
/// that the signs seen so far leave; `lo` itself when f is positive throughout.
template <class Function>
double root_above(const Function& f, double lo, double tolerance) {
  const double reach = std::abs(lo);
  double hi = std::numeric_limits<double>::infinity();
  double at = 0.0;
  for (int k = 0; k < kMaxRootIterations; ++k) {
    const Sample sample = f(at);
    if (std::abs(sample.value) <= tolerance) break;
    (sample.value < 0.0 ? lo : hi) = at;
    double next = sample.slope > 0.0 ? at - sample.value / sample.slope : lo;
    // Where the slope misleads: a bounded step while there is no upper end, then halving, which
    // comes every few steps anyway to bound the work.
    const double furthest = at + reach;
    const bool misled = !(next > lo && next < hi && next <= furthest) || k % 8 == 7;
    if (misled) next = std::isinf(hi) ? furthest : 0.5 * (lo + hi);
    if (next == at) break;
    at = next;
  }
  return at;
}

double slope_of(const Bubble& bubble) {
  double slope = 0.0;
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    if (bubble.start_heights[k] > 0.0) {
      slope += bubble.mobility[k] * bubble.gradient.col(k).squaredNorm();
    }
  }
  return slope;
}

/// After a change of the pressure, and its derivative by the vertices that nothing below stops.
Sample volume_after(double delta, Bubble& bubble) {
  if (bubble.foot_points.are_flat) {
    Sample volume;
    volume.value = bubble.foot_points.column.volume_after(delta, bubble.triangles, volume.slope);
    return volume;
  }
  move_bubble(delta, bubble);
  for (Eigen::Index k = 0; k < bubble.held.size(); ++k) {
    bubble.moved.col(k) -= bubble.held[k] * bubble.foot_points.normal(static_cast<int>(k));
  }
  return {trapped_volume(bubble.triangles, bubble.moved, bubble.foot_points), slope_of(bubble)};
}

}  // namespace

double air_volume(Bubble& bubble) {
  return trapped_volume(bubble.triangles, bubble.x, bubble.foot_points) - bubble.layers;
}

double surplus(const AirGas& gas, double leak, Bubble& bubble) {
  const double gauge = bubble.gauge + bubble.change;
  const double share = std::max(gas.squeeze(gauge), AirGas::kTinyShare);
  const double more = air_volume(bubble) - (bubble.amount - leak * gauge) / share;
  return bubble.amount == 0.0 && gauge == 0.0 ? std::max(0.0, more) : more;
}

double lifted_area(const Bubble& bubble) {
  double sum = 0.0;
  for (Eigen::Index k = 0; k < bubble.areas.size(); ++k) {
    if (bubble.foot_points.heights[k] > kTinyBubbleHeight) sum += bubble.areas[k];
  }
  return sum;
}

void set_volume_condition(const AirGas& gas, double leak, Bubble& bubble,
                          LinearConstraint& condition) {
  trapped_volume_gradient(bubble.triangles, bubble.x, bubble.foot_points, bubble.gradient);
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    Eigen::Vector3d gradient = bubble.gradient.col(k);
    if (!(bubble.foot_points.heights[k] > kTinyBubbleHeight)) {
      const Eigen::Vector3d up = bubble.foot_points.normal(static_cast<int>(k));
      gradient -= up.dot(gradient) * up;
    }
    condition.entries.push_back({bubble.vertices[static_cast<std::size_t>(k)], gradient});
  }
  // V + J d = (V_0 − leak p)/squeeze(p) at p = gauge + Δ, to first order about the change.
  const double gauge = bubble.gauge + bubble.change;
  const double share = std::max(gas.squeeze(gauge), AirGas::kTinyShare);
  const double wanted = (bubble.amount - leak * gauge) / share;
  condition.compliance = (leak + gas.squeeze_slope(gauge) * std::max(0.0, wanted)) / share;
  condition.target = wanted - air_volume(bubble) + condition.compliance * bubble.change;
  condition.least = -(gas.atmosphere + bubble.gauge);
  // What holds no air presses on nothing.
  condition.most = bubble.amount == 0.0 ? -bubble.gauge : std::numeric_limits<double>::infinity();
}

void set_gas_constraint(const AirGas& gas, double leak, Bubble& bubble, TyingConstraint& tie) {
  const double volume = air_volume(bubble), share = gas.squeeze(bubble.gauge);
  // Divided by the share, so that it is one on the volume; near a vacuum, where the law says
  // nothing of that, by no less than a small one.
  const double divisor = std::max(share, kSmallShare);
  const double v = volume > 0.0 ? volume : std::max(0.0, bubble.amount / divisor);
  tie.gap = (share * volume - bubble.amount + leak * bubble.gauge) / divisor;
  tie.compliance = (leak + gas.squeeze_slope(bubble.gauge) * v) / divisor;
  tie.force = bubble.gauge;
  tie.lowest = -(1.0 - AirGas::kTinyShare) * gas.atmosphere;
  // What holds no air presses on nothing.
  tie.highest = bubble.amount == 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
}

double pressing_change(const AirGas& gas, double surplus, double distance, Bubble& bubble) {
  take_gradient(bubble);
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    if (!(bubble.foot_points.heights[k] > 0.0)) bubble.mobility[k] = 0.0;
  }
  const double slope = slope_of(bubble);
  if (!(slope > 0.0)) return 0.0;
  const double most =
      std::min(largest_pressure_change(bubble, distance), gas.atmosphere + bubble.gauge);
  return -std::min(surplus / slope, most);
}

void take_gradient(Bubble& bubble, double expected) {
  bubble.start_heights = bubble.foot_points.heights;
  const bool is_ahead = expected != 0.0 && bubble.gradient.cols() == bubble.x.cols();
  if (is_ahead) move_bubble(expected, bubble);
  trapped_volume_gradient(bubble.triangles, is_ahead ? bubble.moved : bubble.x, bubble.foot_points,
                          bubble.gradient);
  if (!bubble.foot_points.are_flat) return;
  if (is_ahead) bubble.foot_points.column.place(bubble.x, bubble.foot_points.ground);
  bubble.foot_points.column.release(bubble.mobility, bubble.held);
}

void keep_gradient(Bubble& bubble) {
  bubble.start_heights = bubble.foot_points.heights;
  if (!bubble.foot_points.are_flat) return;
  bubble.foot_points.column.place(bubble.x, bubble.foot_points.ground);
  bubble.foot_points.column.release(bubble.mobility, bubble.held);
}

void move_bubble(double delta, Bubble& bubble) {
  bubble.moved.resize(3, bubble.x.cols());
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    bubble.moved.col(k) = bubble.x.col(k) + delta * bubble.mobility[k] * bubble.gradient.col(k);
  }
}

double pressure_change(const AirGas& gas, double leak, Bubble& bubble) {
  const double pa = gas.atmosphere, gauge = bubble.gauge, layers = bubble.layers;
  // V_0 of what is there at the pressure p with Darcy's inflow, V (p/p_a)^(1/γ) = V_0 +
  // h Γ (p_a - p), times p_a; increasing in the pressure.
  const auto excess = [&](double delta) -> Sample {
    const Sample volume = volume_after(delta, bubble);
    const double now = gauge + delta, share = gas.squeeze(now), v = volume.value - layers;
    return {pa * (share * v - bubble.amount + leak * now),
            pa * (gas.squeeze_slope(now) * v + leak + share * volume.slope)};
  };
  const double vacuum = -(pa + gauge);
  const double scale = pa * (bubble.areas.sum() * kTinyBubbleHeight + bubble.amount);
  const double delta = root_above(excess, vacuum, kRelativeTolerance * scale);
  // What holds no air presses on nothing, also where cloth passed through itself and its volume is
  // negative: that is for contact to mend.
  return bubble.amount == 0.0 ? std::min(delta, -gauge) : delta;
}

double largest_pressure_change(const Bubble& bubble, double distance) {
  double largest = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < bubble.x.cols(); ++k) {
    Eigen::Vector3d pull = bubble.gradient.col(k);
    // A particle that lies on the ground is stopped by it, but goes along it.
    if (bubble.start_heights[k] == 0.0) {
      const Eigen::Vector3d normal = bubble.foot_points.normal(static_cast<int>(k));
      pull -= pull.dot(normal) * normal;
    }
    const double speed = bubble.mobility[k] * pull.norm();  // [m/Pa]
    const double back = bubble.held.size() > 0 ? bubble.held[k] : 0.0;
    if (speed > 0.0) largest = std::min(largest, (distance + back) / speed);
  }
  return largest;
}

}  // namespace pliant
