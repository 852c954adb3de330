#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "pliant/effects/registry.h"
#include "pliant/models/registry.h"
#include "pliant/models/solver_registry.h"
#include "pliant/scene/reading/fabrics.h"
#include "pliant/study/judges/body_case.h"
#include "pliant/study/judges/judge.h"
#include "pliant/study/judges/strip_elastica.h"

namespace pliant {
namespace fabric_judges {
namespace {

constexpr double kGravity = 9.81;                  // [m/s²]
constexpr double kInclined = 41.5 / 180.0 * M_PI;  // of ASTM D1388's plane [rad]
const char* const kStripFabric = "royal_target";

double number_in(const ParameterText& material, const std::string& name) {
  return std::stod(material.at(name));
}

std::unique_ptr<Model> cloth_of(const ParameterText& material, const BodyGeometry& geometry) {
  const auto& entry = model_registry().find("cloth");
  return entry.make(parse_parameters(entry.parameters, material, "judge"), geometry);
}

/// Angle below the level of the line from clamp to tip of a strip along the warp that overhangs by
/// `length`, of so many cells [rad].
double chord_angle(const ParameterText& material, double length, int cells) {
  // Both ends of the first cell are held. The second of them turns by what bends the cell and a
  // half next to the end, so that the strip is clamped 1 - 1/1.5 cells beyond the first one's
  // middle.
  constexpr double kClamp = 0.5 + (1.0 - 1.0 / 1.5);  // in cells
  const double cell = length / (cells - kClamp);
  const GridOptions grid{cells * cell, 2.0 * cell, cells + 1, 3};
  BodyCase strip(cloth_of(material, {make_grid(grid), grid}), 1e3);
  const double start = strip.rest().row(0).minCoeff(), clamp = start + kClamp * cell;
  for (int i = 0; i < strip.rest().cols(); ++i) {
    if (strip.rest()(0, i) < start + 1.5 * cell) strip.fix(i);
  }
  strip.set_weight({0.0, 0.0, -kGravity});
  strip.start();
  strip.load(10);
  Eigen::Vector2d tip(0.0, 0.0);
  for (int i = 0; i < strip.rest().cols(); ++i) {
    if (strip.rest()(0, i) < -start - 1e-9) continue;
    tip += Eigen::Vector2d(strip.particles().x(0, i) - clamp, -strip.particles().x(2, i)) / 3.0;
  }
  return std::atan2(tip.y(), tip.x());
}

/// The overhang at which a strip of the fabric comes down to the inclined plane [m].
double measured_overhang(const ParameterText& material, double guess, int cells) {
  double a = 0.95 * guess, b = 1.05 * guess;
  double at_a = chord_angle(material, a, cells), at_b = chord_angle(material, b, cells);
  for (int n = 0; n < 4; ++n) {
    const double next = b + (kInclined - at_b) * (b - a) / (at_b - at_a);
    a = b, at_a = at_b;
    b = next;
    at_b = chord_angle(material, b, cells);
    if (std::abs(at_b - kInclined) < 1e-6) break;
  }
  return b;
}

std::vector<JudgedFigure> judge_fabric_cantilever(const JudgeOptions&) {
  const ParameterText& material = find_fabric(kStripFabric).parameters;
  const double weight = kGravity * number_in(material, "areal_density");
  const double bending = number_in(material, "bending_warp");
  const double unit = std::cbrt(bending / weight);  // Peirce's bending length
  const double overhang = unit * elastica_overhang(kInclined);
  const double fine = measured_overhang(material, overhang, 40);
  const double coarse = measured_overhang(material, overhang, 20);
  const auto read = [&](double length) { return 1e6 * weight * std::pow(0.5 * length, 3); };
  return {{"overhang at 41.5 degrees", "mm", 1e3 * overhang, 1e3 * fine, 1e3 * coarse},
          {"rigidity read by the standard", "uN m", 1e6 * bending, read(fine), read(coarse)}};
}

// ---- Drape --------------------------------------------------------------------------------------

constexpr double kSupport = 0.09, kRadius = 0.15;  // [m]
// Slower than that it rests: what a tolerance of 1e-4 leaves moves it by some mm/s [m/s].
constexpr double kRest = 0.02;

/// What hangs over and a row of cells that the support clamps. Ring k has 6 k vertices, so that
/// triangles are nearly equilateral.
struct DrapeRing {
  TriangleMesh mesh;
  double hole;  ///< radius inside of which there is nothing [m]

  explicit DrapeRing(int rings);
};

DrapeRing::DrapeRing(int rings) {
  const int innermost = rings * 11 / 20;
  hole = kRadius * innermost / rings;
  const auto first = [&](int k) { return 3 * (k * (k - 1) - innermost * (innermost - 1)); };
  mesh.vertices.resize(3, first(rings + 1));
  mesh.triangles.resize(3, 6 * (rings * rings - innermost * innermost));
  const auto at = [&](int ring, int sector, int j) {
    return first(ring) + (sector * ring + j) % (6 * ring);
  };
  int t = 0;
  for (int k = innermost; k <= rings; ++k) {
    for (int j = 0; j < 6 * k; ++j) {
      const double angle = 2.0 * M_PI * j / (6 * k), r = kRadius * k / rings;
      mesh.vertices.col(first(k) + j) << r * std::cos(angle), r * std::sin(angle), 0.0;
    }
    for (int s = 0; s < 6 && k < rings; ++s) {
      for (int j = 0; j <= k; ++j) {
        mesh.triangles.col(t++) << at(k, s, j), at(k + 1, s, j), at(k + 1, s, j + 1);
        if (j < k) mesh.triangles.col(t++) << at(k, s, j), at(k + 1, s, j + 1), at(k, s, j + 1);
      }
    }
  }
}

/// Of all triangles seen from above, on squares of 1 mm [m²].
double shadow_of(const Positions& x, const Eigen::Matrix3Xi& triangles) {
  constexpr double kSquare = 1e-3;
  const int side = static_cast<int>(2.2 * kRadius / kSquare);
  std::vector<char> dark(static_cast<std::size_t>(side * side), 0);
  for (const auto t : triangles.colwise()) {
    Eigen::Matrix<double, 2, 3> p;
    for (int k = 0; k < 3; ++k) p.col(k) = x.col(t[k]).head<2>().array() / kSquare + 0.5 * side;
    const Eigen::Vector2i low = p.rowwise().minCoeff().array().floor().cast<int>().max(0);
    const Eigen::Vector2i high = p.rowwise().maxCoeff().array().ceil().cast<int>().min(side - 1);
    for (int i = low.x(); i <= high.x(); ++i) {
      for (int j = low.y(); j <= high.y(); ++j) {
        double sides[3];
        for (int k = 0; k < 3; ++k) {
          const Eigen::Vector2d along = p.col((k + 1) % 3) - p.col(k);
          const Eigen::Vector2d to = Eigen::Vector2d(i + 0.5, j + 0.5) - p.col(k);
          sides[k] = along.x() * to.y() - along.y() * to.x();
        }
        const auto [least, most] = std::minmax({sides[0], sides[1], sides[2]});
        if (least >= 0.0 || most <= 0.0) dark[static_cast<std::size_t>(i * side + j)] = 1;
      }
    }
  }
  return kSquare * kSquare * static_cast<double>(std::count(dark.begin(), dark.end(), 1));
}

/// Lets the ring fall, with small waves of no direction, until its folds are at rest.
Positions hung(const ParameterText& material, const TriangleMesh& mesh) {
  World world(0.03);
  Body& body = world.add_body("cloth", cloth_of(material, {mesh, {}}));
  world.add_effect(body, effect_registry(), "gravity", {}, "judge");
  world.add_effect(body, effect_registry(), "damping", {{"rate", "10"}}, "judge");
  Particles& p = body.particles();
  std::mt19937 random(3);
  for (int i = 0; i < p.size(); ++i) {
    if (p.x.col(i).norm() < kSupport + 1e-9) {
      p.fix(i);
    } else {
      p.x(2, i) += 1e-4 * (2.0 * static_cast<double>(random()) / 4294967296.0 - 1.0);
    }
  }
  world.system_changed();
  world.set_initial_state();
  world.set_solver(body, all_solvers(), "lbfgs", {{"tolerance", "1e-4"}, {"iterations", "500"}},
                   "judge");
  const auto speed = [&] { return p.v.colwise().norm().maxCoeff(); };
  while (world.time() < 8.0 || speed() > kRest) {
    if (!world.step()) throw std::runtime_error(world.failure());
    if (world.time() > 60.0) {
      throw std::runtime_error(fmt::format("after a minute it still moves at {:.2g} m/s", speed()));
    }
  }
  return p.x;
}

double drape_coefficient(const ParameterText& material, int rings) {
  const DrapeRing ring(rings);
  const Positions x = hung(material, ring.mesh);
  const double inside = M_PI * kSupport * kSupport;
  const double area = shadow_of(x, ring.mesh.triangles) + M_PI * ring.hole * ring.hole;
  return (area - inside) / (M_PI * kRadius * kRadius - inside);
}

/// Regression over many fabrics, with bending stiffness in gf cm²/cm and weight in mg/cm².
double morooka_niwa(const ParameterText& material) {
  constexpr double kUnit = 9.807e-5;  // N m in a gf cm²/cm
  const double weight = 100.0 * number_in(material, "areal_density");
  const double warp = number_in(material, "bending_warp") / kUnit;
  const double weft = number_in(material, "bending_weft") / kUnit;
  return 0.01 * (5.1 + 115.0 * std::cbrt(weft / weight) + 131.1 * std::cbrt(warp / weight) +
                 1.2 * std::cbrt(std::sqrt(warp * weft) / weight));
}

std::vector<JudgedFigure> judge_drape(const JudgeOptions& options) {
  std::vector<JudgedFigure> figures;
  const std::vector<std::string> names = {"gray_interlock", "tango_red_jet_set",
                                          "white_dots_on_black", "pink_ribbon_brown",
                                          "royal_target"};
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!options.go_on(static_cast<double>(k) / static_cast<double>(names.size()))) break;
    const ParameterText& material = find_fabric(names[k]).parameters;
    figures.push_back({"drape coefficient of " + names[k], "", morooka_niwa(material),
                       drape_coefficient(material, 20), drape_coefficient(material, 10)});
  }
  return figures;
}

}  // namespace
}  // namespace fabric_judges

Judge fabric_cantilever_judge() {
  return {"fabric_cantilever",
          "Peirce's cantilever test, ASTM D1388: the heavy elastica (Bickley 1934), solved here to "
          "1e-9, and the standard's own formula, G = w (overhang/2)^3",
          "strip of royal_target along the warp, 40 x 2 cells",
          kComputed,
          true,
          fabric_judges::judge_fabric_cantilever};
}

Judge drape_judge() {
  return {"drape",
          "Cusick 1968 (BS 5058); regression over many fabrics of Morooka and Niwa 1976 (J. Text. "
          "Mach. Soc. Japan 22)",
          "disc of 30 cm over a support of 18 cm; cells of 7.5 mm",
          kMeasured,
          false,
          fabric_judges::judge_drape};
}

}  // namespace pliant
