// A square bar twisted between ends that may warp, Saint-Venant 1855:
//   T = G J θ/L,   J = a⁴ (1/3 - 64/π⁵ Σ tanh(n π/2)/n⁵, n = 1, 3, 5, ...) = 0.1406 a⁴
#include <cmath>

#include "pliant/study/judges/body_case.h"
#include "pliant/study/judges/judge.h"

namespace pliant {
namespace torsion {
namespace {

constexpr double kSide = 0.1, kLength = 0.3, kYoung = 1e6, kPoisson = 0.3;  // [m], [Pa]
constexpr double kAngle = 1e-3;                                             // small [rad]

double saint_venant() {
  double sum = 0.0;
  for (int n = 1; n < 100; n += 2) sum += std::tanh(0.5 * M_PI * n) / std::pow(n, 5);
  const double j = std::pow(kSide, 4) * (1.0 / 3.0 - 64.0 / std::pow(M_PI, 5) * sum);
  return kYoung / (2.0 * (1.0 + kPoisson)) * j * kAngle / kLength;
}

/// The torque on an end, with `cells` across.
double torque(int cells) {
  BodyCase bar(make_block({{kSide, kSide, kLength}, {cells, cells, 3 * cells}}),
               {kYoung, kPoisson, 1000.0}, 1e3);
  const double stiffness = 1e4 * kYoung * kSide / cells;
  for (int i = 0; i < bar.rest().cols(); ++i) {
    const Eigen::Vector3d p = bar.rest().col(i);
    if (std::abs(p.z()) < 0.5 * kLength - 1e-9) continue;
    // The axis does not move.
    if (p.head<2>().norm() < 1e-9) {
      bar.fix(i);
      continue;
    }
    const double angle = p.z() < 0.0 ? 0.0 : kAngle;
    bar.hold({i, 0, p.x() * std::cos(angle) - p.y() * std::sin(angle), stiffness});
    bar.hold({i, 1, p.x() * std::sin(angle) + p.y() * std::cos(angle), stiffness});
  }
  bar.start();
  bar.step();
  double sum = 0.0;
  const Positions& x = bar.particles().x;
  for (const HeldCoordinates::Held& held : bar.held().held()) {
    if (bar.rest()(2, held.particle) < 0.0) continue;
    const double pull = HeldCoordinates::pull(held, x);
    sum += held.axis == 1 ? x(0, held.particle) * pull : -x(1, held.particle) * pull;
  }
  return sum;
}

std::vector<JudgedFigure> judge_torsion(const JudgeOptions&) {
  return {{"torque of a twist of 1 mrad", "N m", saint_venant(), torque(8), torque(4)}};
}

}  // namespace
}  // namespace torsion

Judge torsion_judge() {
  return {"torsion",
          "Saint-Venant 1855, closed form: J = 0.1406 a^4",
          "bar of 0.1 x 0.1 x 0.3 m, E = 1 MPa, Poisson 0.3, ends turn and may warp, 8 x 8 x 24 "
          "cells",
          kComputed,
          true,
          torsion::judge_torsion};
}

}  // namespace pliant
