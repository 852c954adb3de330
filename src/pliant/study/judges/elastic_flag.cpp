// The elastic flag of Turek and Hron 2006, without its fluid: a strip of 0.35 m by 0.02 m behind a
// fixed cylinder of radius 0.05 m, in plane strain, under a weight of 2 m/s² across it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/effects/registry.h"
#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/judges/body_case.h"
#include "pliant/study/judges/judge.h"

namespace pliant {
namespace elastic_flag {
namespace {

constexpr double kCylinder = 0.05, kHeight = 0.02, kEnd = 0.4;  // [m]; from its middle
constexpr double kPoisson = 0.4, kDensity = 1000.0;             // [kg/m³]
constexpr double kGravity = 2.0;                                // [m/s²]
constexpr int kCells = 8;                                       // across

TetrahedralMesh flag_mesh(int cells) {
  const int along = static_cast<int>(std::lround(cells * (kEnd - kCylinder) / kHeight));
  const double depth = kHeight / cells;
  TetrahedralMesh mesh = make_block({{1.0, kHeight, depth}, {along, cells, 1}});
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    const double share = mesh.vertices(0, i) + 0.5, y = mesh.vertices(1, i);
    // It begins on the cylinder.
    const double begin = std::sqrt(kCylinder * kCylinder - y * y);
    mesh.vertices(0, i) = begin + share * (kEnd - begin);
  }
  return mesh;
}

struct ElasticFlag {
  /// Of `cells` across and 17.5 times as many along it.
  ElasticFlag(int cells, double young, double time_step)
      : body(flag_mesh(cells), {young, kPoisson, kDensity}, time_step) {
    const Positions& rest = body.rest();
    for (int i = 0; i < rest.cols(); ++i) {
      if (std::abs(rest.col(i).head<2>().norm() - kCylinder) < 1e-9) body.fix(i);
      if (rest(0, i) > kEnd - 1e-9 && std::abs(rest(1, i)) < 1e-9) tip = i;
    }
    body.hold_plane(young * kHeight / cells);
  }
  /// How far the source's point A, the middle of the free end, came [m].
  Eigen::Vector3d moved() { return body.particles().x.col(tip) - body.rest().col(tip); }

  BodyCase body;
  int tip = 0;
};

/// Where its tip comes to rest [m].
Eigen::Vector3d hanging_tip(int cells, double young) {
  ElasticFlag flag(cells, young, 1e3);
  flag.body.set_weight({0.0, -kGravity, 0.0});
  flag.body.start();
  flag.body.load(4);
  return flag.moved();
}

std::vector<JudgedFigure> judge_statics(const JudgeOptions& options) {
  std::vector<JudgedFigure> figures;
  const auto add = [&](const std::string& name, double young, double x, double y) {
    const Eigen::Vector3d fine = 1e3 * hanging_tip(kCells, young);
    const Eigen::Vector3d coarse = 1e3 * hanging_tip(kCells / 2, young);
    figures.push_back({name + ": tip along the flag", "mm", x, fine.x(), coarse.x()});
    figures.push_back({name + ": tip across it", "mm", y, fine.y(), coarse.y()});
  };
  add("CSM1", 1.4e6, -7.187, -66.10);
  if (options.go_on(0.5)) add("CSM2", 5.6e6, -0.4690, -16.97);
  return figures;
}

/// Mean and amplitude of a coordinate of the tip over whole periods [m], and their frequency.
struct Oscillation {
  double mean = 0.0, amplitude = 0.0, frequency = 0.0;
};

/// From the times at which `values` pass their mean upwards, steps of `dt` [s] apart.
Oscillation oscillation(const std::vector<double>& values, double dt) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  Oscillation found{0.5 * (*most + *least), 0.5 * (*most - *least), 0.0};
  std::vector<double> passed;
  for (std::size_t n = 1; n < values.size(); ++n) {
    const double before = values[n - 1] - found.mean, now = values[n] - found.mean;
    if (before < 0.0 && now >= 0.0) {
      passed.push_back(dt * (static_cast<double>(n - 1) + before / (before - now)));
    }
  }
  if (passed.size() >= 2) {
    found.frequency = static_cast<double>(passed.size() - 1) / (passed.back() - passed.front());
  }
  return found;
}

struct Swing {
  Oscillation along, across;
};

Swing swing(int cells, const JudgeOptions& options, double begun, double share) {
  constexpr double kTimeStep = 0.005, kDuration = 3.0;  // [s]
  ElasticFlag flag(cells, 1.4e6, kTimeStep);
  World& world = flag.body.world();
  world.add_effect(flag.body.body(), effect_registry(), "gravity",
                   {{"acceleration", fmt::format("[0, {}, 0]", -kGravity)}}, "judge");
  flag.body.start("midpoint");
  const int steps = static_cast<int>(std::lround(kDuration / kTimeStep));
  std::vector<double> along = {0.0}, across = {0.0};
  std::string rows = "time_s,along_mm,across_mm\n0,0,0\n";
  for (int n = 1; n <= steps && options.go_on(begun + share * n / steps); ++n) {
    flag.body.step();
    const Eigen::Vector3d moved = flag.moved();
    along.push_back(moved.x());
    across.push_back(moved.y());
    rows += fmt::format("{:.4f},{:.5g},{:.5g}\n", world.time(), 1e3 * moved.x(), 1e3 * moved.y());
  }
  if (!options.folder.empty() && options.go_on(begun + share)) {
    write_file_atomically(options.folder + "/elastic_flag.csv", rows);
  }
  return {oscillation(along, kTimeStep), oscillation(across, kTimeStep)};
}

std::vector<JudgedFigure> judge_dynamics(const JudgeOptions& options) {
  const Swing coarse = swing(kCells / 2, options, 0.0, 0.2);
  const Swing fine = swing(kCells, options, 0.2, 0.8);
  return {
      {"CSM3: mean along the flag", "mm", -14.305, 1e3 * fine.along.mean, 1e3 * coarse.along.mean},
      {"CSM3: amplitude along it", "mm", 14.305, 1e3 * fine.along.amplitude,
       1e3 * coarse.along.amplitude},
      {"CSM3: mean across it", "mm", -63.607, 1e3 * fine.across.mean, 1e3 * coarse.across.mean},
      {"CSM3: amplitude across it", "mm", 65.160, 1e3 * fine.across.amplitude,
       1e3 * coarse.across.amplitude},
      {"CSM3: frequency", "Hz", 1.0995, fine.across.frequency, coarse.across.frequency}};
}

const char* const kSource =
    "Turek and Hron 2006 (Fluid-Structure Interaction, LNCSE 53, tables of CSM1 to CSM3)";

}  // namespace
}  // namespace elastic_flag

Judge elastic_flag_statics_judge() {
  return {"elastic_flag_statics",
          elastic_flag::kSource,
          "flag of 0.35 x 0.02 m behind a cylinder, E = 1.4 and 5.6 MPa, Poisson 0.4, 1000 kg/m3, "
          "2 m/s2, plane strain; corotated instead of St. Venant-Kirchhoff; 8 cells across",
          kComputed,
          true,
          elastic_flag::judge_statics};
}

Judge elastic_flag_judge() {
  return {"elastic_flag",
          elastic_flag::kSource,
          "the flag of 1.4 MPa let go, steps of 5 ms as the source's, midpoint; 8 cells across",
          kComputed,
          false,
          elastic_flag::judge_dynamics,
          true};
}

}  // namespace pliant
