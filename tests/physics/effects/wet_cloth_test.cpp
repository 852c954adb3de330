// Wet cloth: what it weighs when it hangs, and what it takes to peel it off.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/effects/air/air.h"
#include "pliant/effects/wetness/wetness.h"
#include "support/solvers/projective_model.h"
#include "support/solvers/stable_step.h"
#include "support/worlds/worlds.h"

namespace pliant::wet_cloth_test {
namespace {

/// What the springs pull at fixed vertices [N].
Eigen::Vector3d pull_at(World& world, const std::vector<int>& held) {
  Forces f = Forces::Zero(3, particles_of(world).size());
  const auto& system = projective_system(*body_of(world).model);
  for (const auto& set : system.elements) set->add_forces(particles_of(world).x, f);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i : held) sum += f.col(i);
  return sum;
}

TEST(WetCloth, HangingItWeighsItsClothAndItsWater) {
  for (const char* wetness : {"0", "1"}) {
    ClothScene s;
    s.solver = "lbfgs";
    s.solver_parameters = {{"iterations", "100"}, {"tolerance", "1e-8"}};
    s.time_step = 0.02;
    s.pose.linear() = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
    s.fixed = row_of(s.grid, 6);
    s.effects = {{"gravity", {}},
                 {"damping", {{"rate", "5"}}},
                 {"wetness", {{"wetness", wetness}, {"capacity", "0.3"}}}};
    const auto world = make_world(s);
    run_for(*world, 8.0);
    double held = 0.0;
    for (int i : s.fixed) held += particles_of(*world).mass[i];
    const double weight = -pull_at(*world, s.fixed).z() + 9.81 * held;
    const double wanted = 9.81 * (0.15 + std::stod(wetness) * 0.3) * 0.09;
    EXPECT_NEAR(weight, wanted, 1e-4 * wanted);
  }
}

// Peeled off at a right angle a strip costs adhesion x range per area: that is the force per width,
// on average over the cells that come off one after the other. The hand moves up and along as the
// strip comes off, so that its free part stands upright.
class WetPeel : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, WetPeel, testing::Values("lbfgs", "newton"), test_name_of);

TEST_P(WetPeel, ForceIsAdhesionTimesWidth) {
  constexpr double kCell = 0.005, kWidth = 0.02, kPull = 100.0, kRange = 2.5e-3, kSpeed = 0.01;
  ClothScene s;
  s.grid = {30 * kCell, kWidth, 31, 3};
  s.solver = GetParam();
  s.solver_parameters = {{"iterations", "15"}};
  s.time_step = 2e-3;
  s.obstacles = {obstacle(Plane())};
  s.pose = at(0, 0, 0.001);
  s.material = {{"stretch_warp", "2000"}, {"stretch_weft", "2000"}, {"bending", "0"}};
  std::vector<int> hand, end;
  for (int r = 0; r < 3; ++r) {
    hand.push_back(vertex(s.grid, r, 0));
    end.push_back(vertex(s.grid, r, 30));
  }
  s.fixed = hand;
  s.fixed.insert(s.fixed.end(), end.begin(), end.end());
  s.effects = {{"damping", {{"rate", "1"}}},
               {"contact", {}},
               {"wetness",
                {{"adhesion", std::to_string(kPull)},
                 {"adhesion_range", std::to_string(kRange)},
                 {"capacity", "0.05"}}}};
  const auto world = make_world(s);
  const double travel = kSpeed * s.time_step;
  const auto peel = [&](double length) {
    double work = 0.0;
    for (int k = 0; k < static_cast<int>(std::lround(length / travel)); ++k) {
      for (int i : hand) {
        particles_of(*world).x(0, i) += travel;
        particles_of(*world).x(2, i) += travel;
      }
      EXPECT_TRUE(world->step()) << world->failure();
      work -= pull_at(*world, hand).dot(Eigen::Vector3d(travel, 0, travel));
    }
    return work / length;
  };
  // From the slack after one row of vertices came off to that after another.
  peel(3.8 * kCell);
  const double wanted = kPull * kRange * kWidth;
  EXPECT_NEAR(peel(15 * kCell), wanted, 0.05 * wanted);
}

/// Water holds the cloth down at every iteration and air lifts it: neither undoes the other.
class AirUnderWetCloth : public EverySolver {
 protected:
  ClothScene lying(const std::string& adhesion, const std::string& fill_time) const {
    ClothScene s;
    s.material = soft_material();
    s.obstacles = {obstacle(Plane())};
    s.pose = at(0, 0, 0.001);  // half the thickness: where contact holds it
    s.solver = solver();
    s.solver_parameters = few_iterations(solver(), 20);
    s.effects = {{"gravity", {}},
                 {"air", {{"volume", "3e-4"}, {"fill_time", fill_time}, {"seal_breaks", "false"}}},
                 {"contact", {{"thickness", "0.002"}}},
                 {"wetness", {{"wetness", "1"}, {"adhesion", adhesion}}}};
    return s;
  }
  static const AirEffect& air(World& world) { return effect_of<AirEffect>(world, "air"); }
};
PLIANT_FOR_EVERY_SOLVER(AirUnderWetCloth);

TEST_P(AirUnderWetCloth, IsLiftedByIt) {
  for (const char* adhesion : {"0", "100", "1440"}) {
    for (const char* fill_time : {"0", "0.1"}) {
      const auto world = make_stable_world(lying(adhesion, fill_time));
      run_for(*world, 0.2);
      const std::string what = std::string(adhesion) + " Pa, filled in " + fill_time + " s";
      EXPECT_NEAR(air(*world).amount(), 3e-4, 1e-12) << what;
      // Its weight presses the air together by less than a thousandth.
      EXPECT_NEAR(air(*world).volume(particles_of(*world).x), 3e-4, 0.02 * 3e-4) << what;
      EXPECT_LT(world->energies().kinetic, 1e-3) << what;
    }
  }
}

// A grip of a fifth of the atmosphere is let go of in the middle first, which then takes the air.
TEST_P(AirUnderWetCloth, AStrongGripLeavesTheSameBlister) {
  const auto after = [&](const std::string& solver, const ParameterText& parameters) {
    ClothScene s = lying("20000", "0.1");
    s.time_step = 1e-3;
    s.solver = solver;
    s.solver_parameters = parameters;
    auto world = make_stable_world(s);
    run_for(*world, 0.3);
    return world;
  };
  const auto own = after(solver(), few_iterations(solver(), 20));
  const auto converged = after("newton", {});
  const auto height = [](World& world) { return particles_of(world).x.row(2).maxCoeff(); };
  EXPECT_NEAR(air(*own).volume(particles_of(*own).x), 3e-4, 0.01 * 3e-4);
  EXPECT_NEAR(height(*own), height(*converged), 0.05 * height(*converged));
  EXPECT_GT(height(*converged), 2.0 * 3e-4 / 0.09) << "no plate";
}

TEST_P(AirUnderWetCloth, OverAnyObstacle) {
  ClothScene s = lying("1440", "0.1");
  s.obstacles = {obstacle(Box(Eigen::Vector3d(1, 1, 0.1)), at(0, 0, -0.05))};
  const auto world = make_stable_world(s);
  run_for(*world, 0.2);
  EXPECT_NEAR(air(*world).volume(particles_of(*world).x), 3e-4, 0.02 * 3e-4);
}

TEST_P(AirUnderWetCloth, EnergyOfAirThatIsPressedDoesNotVanish) {
  const auto world = make_stable_world(lying("1440", "0.1"));
  run_for(*world, 0.15);
  // Lowered little by little, to nothing at last: it takes ever more work.
  Positions& x = particles_of(*world).x;
  const double lying_height = 0.001;
  double last = body_of(*world).find_effect("air")->potential_energy(body_of(*world));
  for (const double share : {0.5, 0.2, 1e-2, 1e-3, 0.0}) {
    Positions pressed = x;
    pressed.row(2) = (pressed.row(2).array() - lying_height) * share + lying_height;
    std::swap(x, pressed);
    const double energy = body_of(*world).find_effect("air")->potential_energy(body_of(*world));
    std::swap(x, pressed);
    EXPECT_GT(energy, last) << share;
    last = energy;
  }
  EXPECT_GT(last, 100.0) << "p V ln V, of an atmosphere and a third of a litre";
}

}  // namespace
}  // namespace pliant::wet_cloth_test
