#include "pliant/study/generated/generated_body.h"

#include <fmt/format.h>

#include <cmath>

namespace pliant {
namespace {

int at(const SceneChoice& choice, Factor factor) { return choice[factor]; }
bool is_fine(const SceneChoice& choice) { return at(choice, kFactorSize) > 0; }

/// The usual value times what the stiffness says.
double stiff(const SceneChoice& choice, double usual, double soft, double stiff, double hard) {
  const double factors[] = {1.0, soft, stiff, hard};
  return usual * factors[at(choice, kFactorStiffness)];
}

double cloth_stretch(const SceneChoice& choice) { return stiff(choice, 500.0, 0.02, 100.0, 1e4); }
double solid_young(const SceneChoice& choice) { return stiff(choice, 1e4, 0.01, 100.0, 1e5); }

std::string diagonal(const BodyMesh& mesh) { return mesh.is_mirrored ? "[1, -1, 0]" : "[1, 1, 0]"; }

std::string cloth_text(const SceneChoice& choice, const SceneUnits& u, const BodyMesh& mesh) {
  const int n = is_fine(choice) ? 11 : 6;
  const std::string geometries[] = {
      fmt::format("{{grid: {{size: [{0}, {0}], vertices: [{1}, {1}]}}}}", u(0.1, 0, 1), n),
      fmt::format("{{tube: {{radius: {}, length: {}, around: {}, along: {}}}}}", u(0.04, 0, 1),
                  u(0.08, 0, 1), 2 * n, n),
      fmt::format("{{holed_sheet: {{width: {0}, height: {0}, hole: {1}, side: {2}, rings: {3}}}}}",
                  u(0.1, 0, 1), u(0.02, 0, 1), n / 2, n / 3)};
  // The diagonals are of a grid alone.
  const bool is_grid = at(choice, kFactorShape) == 0 && mesh.path.empty();
  const std::string flags[] = {"",
                               is_grid ? ", diagonals: 1" : ", warp_direction: " + diagonal(mesh),
                               ", damping: 0.01", fmt::format(", bending_warp: {}", u(1e-4, 1, 2))};
  const double stretch = cloth_stretch(choice);
  return fmt::format(
      "geometry: {}, material: {{areal_density: {}, stretch_warp: {}, stretch_weft: {}, shear: {}, "
      "bending: {}{}}}",
      mesh.path.empty() ? geometries[at(choice, kFactorShape)]
                        : fmt::format("{{mesh: {}}}", mesh.path),
      u(0.15, 1, -2), u(stretch, 1, 0), u(0.8 * stretch, 1, 0), u(0.1 * stretch, 1, 0),
      u(1e-5, 1, 2), flags[at(choice, kFactorFlags)]);
}

std::string patch_text(const SceneChoice& choice, const SceneUnits& u, const BodyMesh& mesh) {
  const std::string filled = fmt::format("tetrahedra: {}", is_fine(choice) ? 250 : 60);
  const std::string geometries[] = {
      fmt::format("{{block: {{size: [{}, {}, {}], cells: {}}}}}", u(0.1, 0, 1), u(0.08, 0, 1),
                  u(0.06, 0, 1), is_fine(choice) ? "[4, 3, 2]" : "[2, 2, 1]"),
      fmt::format("{{sphere: {{radius: {}}}, {}}}", u(0.04, 0, 1), filled),
      fmt::format("{{capsule: {{radius: {}, length: {}}}, {}}}", u(0.03, 0, 1), u(0.04, 0, 1),
                  filled)};
  const std::string flags[] = {
      "", ", strain: averaged, poisson: 0.45",
      fmt::format(", fiber_stiffness: {}, fiber_direction: {}", u(1e5, 1, -1), diagonal(mesh)),
      ", damping: 0.01, poisson: 0.49"};
  return fmt::format("geometry: {}, material: {{young: {}, density: {}{}}}",
                     mesh.path.empty() ? geometries[at(choice, kFactorShape)]
                                       : fmt::format("{{tetrahedral_mesh: {}}}", mesh.path),
                     u(solid_young(choice), 1, -1), u(1000.0, 1, -3),
                     flags[at(choice, kFactorFlags)]);
}

std::string viscoelastic_text(const SceneChoice& choice, const SceneUnits& u) {
  const std::string filled = fmt::format("particles: {}", is_fine(choice) ? 150 : 60);
  const std::string geometries[] = {
      fmt::format("{{block: {{size: [{}, {}, {}]}}, {}}}", u(0.1, 0, 1), u(0.08, 0, 1),
                  u(0.06, 0, 1), filled),
      fmt::format("{{sphere: {{radius: {}}}, {}}}", u(0.04, 0, 1), filled),
      fmt::format("{{torus: {{ring: {}, tube: {}}}, {}}}", u(0.04, 0, 1), u(0.015, 0, 1), filled)};
  const std::string flags[] = {"state: elastic", "state: elastic, oriented: true", "state: liquid",
                               "state: viscoelastic"};
  return fmt::format(
      "geometry: {}, material: {{{}, young: {}, density: {}, sound_speed: {}, viscosity: {}}}",
      geometries[at(choice, kFactorShape)], flags[at(choice, kFactorFlags)],
      u(solid_young(choice), 1, -1), u(1000.0, 1, -3), u(kGeneratedSound, 0, 1),
      u(stiff(choice, 0.1, 0.01, 10.0, 100.0), 1, -1));
}

std::string reduced_text(const SceneChoice& choice, const SceneUnits& u) {
  const char* const kinds[] = {"", ", rank: 6, modes: 4", ", strain: averaged"};
  const char* const flags[] = {"", "alpha: 1", "beta: 0.001", "alpha: 1, beta: 0.001"};
  return fmt::format(
      "geometry: {{example: {{name: beam, scale: {}, young: {}, density: {}{}}}, contact_spacing: "
      "{}}}, material: {{{}}}",
      u(0.1, 0, 1), u(stiff(choice, 1e6, 0.1, 10.0, 100.0), 1, -1), u(1000.0, 1, -3),
      kinds[at(choice, kFactorShape)], u(0.01, 0, 1), flags[at(choice, kFactorFlags)]);
}

std::string rigid_text(const SceneChoice& choice, const SceneUnits& u) {
  const std::string geometries[] = {
      fmt::format("{{box: {{size: [{}, {}, {}]}}, contact_spacing: {}}}", u(0.1, 0, 1),
                  u(0.08, 0, 1), u(0.06, 0, 1), u(0.02, 0, 1)),
      fmt::format("{{sphere: {{radius: {}}}, contact_spacing: {}}}", u(0.04, 0, 1), u(0.02, 0, 1)),
      fmt::format("{{cylinder: {{radius: {}, length: {}}}, contact_spacing: {}}}", u(0.04, 0, 1),
                  u(0.05, 0, 1), u(0.02, 0, 1))};
  return fmt::format("geometry: {}, material: {{density: {}}}",
                     geometries[at(choice, kFactorShape)],
                     u(stiff(choice, 1000.0, 0.01, 20.0, 1000.0), 1, -3));
}

}  // namespace

double SceneUnits::scaled(double value, int mass, int meters) const {
  return value * std::pow(length_, 3 * mass + meters);
}

std::string SceneUnits::operator()(double value, int mass, int meters) const {
  return fmt::format("{:.17g}", scaled(value, mass, meters));
}

BodyExtent extent_of(const SceneChoice& choice) {
  static const BodyExtent extents[5][3] = {
      {{0.0, 0.071}, {0.04, 0.057}, {0.0, 0.071}},       // cloth
      {{0.03, 0.071}, {0.04, 0.04}, {0.05, 0.05}},       // patch
      {{0.03, 0.071}, {0.04, 0.04}, {0.015, 0.055}},     // viscoelastic
      {{0.004, 0.101}, {0.004, 0.101}, {0.004, 0.101}},  // reduced
      {{0.03, 0.071}, {0.04, 0.04}, {0.025, 0.048}}};    // rigid
  return extents[at(choice, kFactorModel)][at(choice, kFactorShape)];
}

bool may_be_read(const SceneChoice& choice) { return at(choice, kFactorModel) < 2; }

double wave_speed(const SceneChoice& choice) {
  switch (at(choice, kFactorModel)) {
    case 0:
      return std::sqrt(cloth_stretch(choice) / 0.15);
    case 3:
      return std::sqrt(stiff(choice, 1e6, 0.1, 10.0, 100.0) / 1000.0);
    case 4:
      return 0.0;
    default:
      // Of nearly incompressible ones, 1 / sqrt(1 - 2 nu) times as fast.
      return 7.0 * std::sqrt(solid_young(choice) / 1000.0);
  }
}

std::string body_text(const SceneChoice& choice, const SceneUnits& units, const BodyMesh& mesh) {
  switch (at(choice, kFactorModel)) {
    case 0:
      return cloth_text(choice, units, mesh);
    case 1:
      return patch_text(choice, units, mesh);
    case 2:
      return viscoelastic_text(choice, units);
    case 3:
      return reduced_text(choice, units);
    default:
      return rigid_text(choice, units);
  }
}

}  // namespace pliant
