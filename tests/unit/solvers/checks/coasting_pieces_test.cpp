// How far bodies coast with a velocity that they should not have, until they touch something.
#include "pliant/solvers/checks/coasting_pieces.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant::coasting_pieces_test {
namespace {

/// Particles 0 and 1 are of piece 0, particle 2 of piece 1, and 3 is held.
const std::vector<int> kPieceOf = {0, 0, 1, -1};

CoastingPieces pieces() {
  const Eigen::VectorXd mass = Eigen::Vector4d(1.0, 3.0, 2.0, 5.0);
  Eigen::Matrix3Xd gained(3, 4);
  gained << 4, 0, 1, 7,  //
      0, 4, 2, 7,        //
      0, 0, 3, 7;
  CoastingPieces pieces;
  pieces.begin(2, mass, gained, kPieceOf);
  return pieces;
}

/// Piece 1 stands on something.
HeldDirections held_from_below() {
  PointConstraints constraints;
  PointConstraint& constraint = constraints.append();
  constraint.normal = Eigen::Vector3d::UnitZ();
  constraint.normal_force = 1.0;
  constraints.add(2, 1.0);
  HeldDirections held;
  held.find(constraints, kPieceOf, 2);
  return held;
}

TEST(CoastingPieces, GoOnWithTheMeanVelocityOfTheirMass) {
  CoastingPieces coasting = pieces();
  EXPECT_EQ(coasting.gone(0), Eigen::Vector3d::Zero());
  coasting.go_on(0, 2.0);
  coasting.go_on(0, 3.0);
  EXPECT_NEAR((coasting.gone(0) - 5.0 * Eigen::Vector3d(1, 3, 0)).norm(), 0.0, 1e-12);
  EXPECT_EQ(coasting.gone(1), Eigen::Vector3d::Zero());
}

TEST(CoastingPieces, ContactTakesTheirVelocityForGood) {
  CoastingPieces coasting = pieces();
  const double resting = 4.0, left = std::exp(-2.0 / resting);
  coasting.go_on(1, 2.0, held_from_below(), resting);
  const Eigen::Vector3d open(1, 2, 0), gone = resting * (1.0 - left) * open;
  EXPECT_NEAR((coasting.gone(1) - gone).norm(), 0.0, 1e-12);
  // It does not come back when the contact opens.
  coasting.go_on(1, 5.0);
  EXPECT_NEAR((coasting.gone(1) - gone - 5.0 * left * open).norm(), 0.0, 1e-12);
}

TEST(CoastingPieces, ManyStepsInContactAreAsGoodAsOneLongOne) {
  CoastingPieces one = pieces(), many = pieces();
  one.go_on(1, 6.0, held_from_below(), 4.0);
  for (int k = 0; k < 6; ++k) many.go_on(1, 1.0, held_from_below(), 4.0);
  EXPECT_NEAR((one.gone(1) - many.gone(1)).norm(), 0.0, 1e-12);
}

TEST(CoastingPieces, GoOnFromASavedState) {
  CoastingPieces coasting = pieces(), loaded;
  coasting.go_on(0, 2.0);
  StateArchive numbers;
  coasting.save(numbers);
  numbers.rewind();
  loaded.load(numbers);
  for (CoastingPieces* each : {&coasting, &loaded}) each->go_on(0, 1.0);
  EXPECT_EQ(loaded.gone(0), coasting.gone(0));
}

// One that a solver wrote that knew of none.
TEST(CoastingPieces, StandStillAfterAnArchiveThatEnds) {
  StateArchive numbers;
  CoastingPieces coasting = pieces();
  coasting.load(numbers);
  coasting.go_on(0, 1.0);
  EXPECT_EQ(coasting.gone(0), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace pliant::coasting_pieces_test
