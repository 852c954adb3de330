// What the final projections of others keep of the air, and what it takes back when all of them
// alternate.
#include <algorithm>
#include <cmath>

#include "pliant/effects/air/air.h"
#include "pliant/effects/air/bubble_pressure.h"

namespace pliant {
namespace {

// Mean height of what is lifted by which the volume may be missed [m], and share of it below which
// a bubble is none.
constexpr double kLeftOver = 3e-5, kNoVolume = 0.2;
// Share of the thickness of two layers by which settling presses them: where the mesh cannot crease
// more sharply, what self-contact leaves between them has to go somewhere.
constexpr double kPressed = 0.2;

}  // namespace

template <class Use>
void AirEffect::for_each_sealed(const Use& use) {
  for (Bubble& bubble : bubbles_.all()) {
    if (!bubble.is_open) use(bubble);
  }
  use(bubbles_.lying());
}

double AirEffect::missed_linear_constraints(const Positions& x) {
  double worst = 0.0;
  for_each_sealed([&](Bubble& bubble) {
    gather(x, bubble);
    const double area = lifted_area(bubble);
    if (area == 0.0) return;
    const double more = surplus(options_.gas, dt_ * bubble.conductance, bubble);
    worst = std::max(worst, std::abs(more) / (kLeftOver * area));
  });
  return worst;
}

void AirEffect::add_linear_constraints(const Positions& x, LinearConstraints& conditions) {
  int number = 0;
  for_each_sealed([&](Bubble& bubble) {
    gather(x, bubble);
    const double own = trapped_volume(bubble.triangles, bubble.x, bubble.foot_points);
    if (own > kNoVolume * kLeftOver * lifted_area(bubble)) {
      LinearConstraint& condition = conditions.append();
      set_volume_condition(options_.gas, dt_ * bubble.conductance, bubble, condition);
      condition.owner = this;
      condition.number = number;
    }
    ++number;
  });
}

void AirEffect::set_change(int number, double change) {
  int own = 0;
  for_each_sealed([&](Bubble& bubble) {
    if (own++ == number) bubble.change = change;
  });
}

void AirEffect::take_changes() {
  for_each_sealed([&](Bubble& bubble) {
    bubble.gauge = std::max(bubble.gauge + bubble.change, -options_.gas.atmosphere);
    bubble.change = 0.0;
  });
}

double AirEffect::alternating_projection(const Eigen::VectorXd& mobility, Positions& x) {
  const double most = kPressed * layer_thickness();
  double worst = 0.0;
  for_each_sealed([&](Bubble& bubble) {
    if (bubble.pressed >= most) return;
    gather(x, bubble);
    const double more = surplus(options_.gas, dt_ * bubble.conductance, bubble);
    const double area = lifted_area(bubble);
    const double missed = area > 0.0 ? more / (kLeftOver * area) : 0.0;
    if (!(missed > 1.0)) {
      // All that lies is much to look at in each round.
      if (&bubble == &bubbles_.lying()) bubble.pressed = most;
      return;
    }
    worst = std::max(worst, missed);
    gather_mobility(mobility, bubble);
    bubble.held.setZero();  // contact had its final projection
    const double change = pressing_change(options_.gas, more, most - bubble.pressed, bubble);
    bubble.pressed -= change / largest_pressure_change(bubble, 1.0);
    bubble.gauge += change;
    move_bubble(change, bubble);
    scatter(bubble, x);
  });
  return worst;
}

}  // namespace pliant
