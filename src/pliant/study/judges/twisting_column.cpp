// A column on the ground that begins to twist fast enough to wind itself up by more than a turn
// (Bonet, Gil, Lee, Aguirre and Ortigosa 2015). Nothing does work on it, so that its energy stays.
#include <fmt/format.h>

#include <cmath>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/judges/body_case.h"
#include "pliant/study/judges/judge.h"

namespace pliant {
namespace twisting_column {
namespace {

constexpr double kSide = 1.0, kHeight = 6.0;             // [m]
constexpr double kFastest = 105.0;                       // [rad/s], at the top
constexpr double kTimeStep = 5e-4, kDuration = 0.2;      // [s]
const ElasticMaterial kRubber = {1.7e7, 0.495, 1100.0};  // [Pa], [kg/m³]

double total_energy(BodyCase& column) {
  return column.body().model->system().elastic_energy() + column.particles().kinetic_energy();
}

/// Energy at the end over that at the start.
double energy_kept(int cells, const JudgeOptions& options, double begun, double share) {
  BodyCase column(make_block({{kSide, kSide, kHeight}, {cells, cells, 6 * cells}}), kRubber,
                  kTimeStep);
  const Positions& rest = column.rest();
  const double low = -0.5 * kHeight;
  int corner = 0;
  for (int i = 0; i < rest.cols(); ++i) {
    const double z = rest(2, i) - low;
    if (z < 1e-9) column.fix(i);
    if (z > kHeight - 1e-9) corner = i;
    const Eigen::Vector3d omega(0.0, 0.0, kFastest * std::sin(0.5 * M_PI * z / kHeight));
    if (z >= 1e-9) column.particles().v.col(i) = omega.cross(Eigen::Vector3d(rest.col(i)));
  }
  column.start("midpoint");
  const double start = total_energy(column);
  const int steps = static_cast<int>(std::lround(kDuration / kTimeStep));
  double angle = 0.0;
  Eigen::Vector2d last = rest.col(corner).head<2>();
  std::string rows = "time_s,turned_rad,energy_share\n";
  for (int n = 1; n <= steps; ++n) {
    column.step();
    const Eigen::Vector2d arm = column.particles().x.col(corner).head<2>();
    angle += std::atan2(last.x() * arm.y() - last.y() * arm.x(), last.dot(arm));
    last = arm;
    rows +=
        fmt::format("{:.4f},{:.5g},{:.6g}\n", n * kTimeStep, angle, total_energy(column) / start);
    if (!options.go_on(begun + share * n / steps)) break;
  }
  if (!options.folder.empty() && options.go_on(begun + share)) {
    write_file_atomically(options.folder + "/twisting_column.csv", rows);
  }
  return total_energy(column) / start;
}

std::vector<JudgedFigure> judge_twisting_column(const JudgeOptions& options) {
  const double coarse = energy_kept(2, options, 0.0, 0.15);
  const double fine = energy_kept(4, options, 0.15, 0.85);
  return {{"energy after 0.2 s over that at the start", "", 1.0, fine, coarse}};
}

}  // namespace
}  // namespace twisting_column

Judge twisting_column_judge() {
  return {"twisting_column",
          "Bonet, Gil, Lee, Aguirre and Ortigosa 2015 (CMAME 283); conservation of energy",
          "column of 1 x 1 x 6 m, E = 17 MPa, Poisson 0.495, 1100 kg/m3, 105 sin(pi z/12) rad/s, "
          "midpoint, 0.5 ms, 4 x 4 x 24 cells",
          kComputed,
          false,
          twisting_column::judge_twisting_column};
}

}  // namespace pliant
