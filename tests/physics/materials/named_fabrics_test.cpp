// Every fabric that Pliant names, measured as one measures fabrics: a piece between two grips is
// pulled along warp and along weft, and another one is sheared.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/models/registry.h"
#include "pliant/scene/reading/fabrics.h"
#include "support/solvers/projective_model.h"
#include "support/solvers/statics.h"

namespace pliant::named_fabrics_test {
namespace {

const GridOptions kPiece{0.12, 0.08, 13, 9};  // cells of 1 cm
constexpr double kStrain = 0.01;

enum class Mesh { kGrid, kTriangles };

class Piece {
 public:
  Piece(const Fabric& fabric, Mesh mesh) {
    const auto& entry = model_registry().find("cloth");
    BodyGeometry geometry{make_grid(kPiece), {}};
    if (mesh == Mesh::kGrid) geometry.grid = kPiece;
    cloth_ = entry.make(parse_parameters(entry.parameters, fabric.parameters, "test"), geometry);
    rest_ = cloth_->particles().x;
  }

  /// Moves vertices where `is_held` says so by `map`, lets the others come to rest; the forces.
  template <class Held>
  Forces pull(const Eigen::Matrix3d& map, const Held& is_held) {
    std::vector<const ElementSet*> sets;
    for (const auto& set : projective_system(*cloth_).elements) sets.push_back(set.get());
    Statics statics(sets, cloth_->particles().size());
    x_ = rest_;
    for (int i = 0; i < x_.cols(); ++i) {
      if (!is_held(rest_.col(i))) continue;
      statics.fix(i);
      x_.col(i) = map * rest_.col(i);
    }
    EXPECT_LE(statics.solve(x_), 1e-9);
    energy_ = statics.energy(x_);
    return statics.forces(x_);
  }
  double energy() const { return energy_; }

 private:
  std::unique_ptr<Model> cloth_;
  Positions rest_, x_;
  double energy_ = 0.0;
};

/// Force per width and strain along `axis`, between grips that let the fabric be as wide as it
/// likes: this one has no reason to become narrower.
double tension(Piece& piece, int axis) {
  const double half = 0.5 * (axis == 0 ? kPiece.width : kPiece.height);
  const double width = axis == 0 ? kPiece.height : kPiece.width;
  Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
  map(axis, axis) += kStrain;
  const auto is_held = [&](const Eigen::Vector3d& x) {
    return std::abs(std::abs(x[axis]) - half) < 1e-9;
  };
  const Forces f = piece.pull(map, is_held);
  double sum = 0.0;
  for (double value : f.row(axis)) sum += 0.5 * std::abs(value);
  return sum / width / kStrain;
}

/// Shear force per width and angle, by the work of a frame all around.
double shear(Piece& piece) {
  constexpr double kAngle = 1e-3;
  Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
  map(0, 1) = map(1, 0) = 0.5 * kAngle;
  piece.pull(map, [](const Eigen::Vector3d& x) {
    return std::abs(x.x()) > 0.5 * kPiece.width - 1e-9 ||
           std::abs(x.y()) > 0.5 * kPiece.height - 1e-9;
  });
  return 2.0 * piece.energy() / (kAngle * kAngle * kPiece.width * kPiece.height);
}

class NamedFabrics : public testing::TestWithParam<Mesh> {};

TEST_P(NamedFabrics, MeasureAsNamed) {
  for (const Fabric& fabric : fabrics()) {
    const auto named = [&](const char* key) { return std::stod(fabric.parameters.at(key)); };
    Piece piece(fabric, GetParam());
    EXPECT_NEAR(tension(piece, 0) / named("stretch_warp"), 1.0, 0.01) << fabric.name;
    EXPECT_NEAR(tension(piece, 1) / named("stretch_weft"), 1.0, 0.01) << fabric.name;
    EXPECT_NEAR(shear(piece) / named("shear"), 1.0, 0.01) << fabric.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, NamedFabrics, testing::Values(Mesh::kGrid, Mesh::kTriangles),
                         [](const auto& info) {
                           return info.param == Mesh::kGrid ? "grid" : "triangles";
                         });

TEST(NamedFabrics, SpringsAlongDiagonalsStiffenStretch) {
  // What `grid_shear: springs` is: the law of earlier work, by its own name.
  Fabric fabric = find_fabric("ivory_rib_knit");
  fabric.parameters["grid_shear"] = "springs";
  Piece piece(fabric, Mesh::kGrid);
  const double weft = std::stod(fabric.parameters.at("stretch_weft"));
  EXPECT_GE(tension(piece, 1) / weft, 1.5);
}

}  // namespace
}  // namespace pliant::named_fabrics_test
