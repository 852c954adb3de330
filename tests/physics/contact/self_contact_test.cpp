// Contact between parts of one body and of a part with itself.
#include "pliant/effects/self_contact/self_contact.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/meshes/overlap.h"

namespace pliant::self_contact_test {
namespace {

SolidPart block_at(const Eigen::Vector3d& center, const BlockOptions& options,
                   const ElasticMaterial& material = {2e4, 0.3, 1000.0}) {
  SolidPart part{make_block(options), Eigen::Isometry3d::Identity(), material};
  part.pose.translation() = center;
  return part;
}

/// The particles of the first part that lie on its lower side.
std::vector<int> feet(const SolidScene& scene) {
  std::vector<int> feet;
  for (int i = 0; i < scene.parts[0].rest.vertices.cols(); ++i) {
    if (on_face(scene.parts[0].rest, i, 2, -1)) feet.push_back(i);
  }
  return feet;
}

Forces contact_forces(World& world) {
  Forces f = Forces::Zero(3, particles_of(world).size());
  effect_of<SelfContactEffect>(world, "self_contact").add_forces(f);
  return f;
}

Eigen::Vector3d force_on(World& world, int part) {
  const SolidModel& model = solid_of(world);
  return contact_forces(world).middleCols(model.first(part), model.count(part)).rowwise().sum();
}

double mass_of(const World& world, int part) {
  const SolidModel& model = solid_of(world);
  return model.particles().mass.segment(model.first(part), model.count(part)).sum();
}

std::vector<std::string> implicit_solvers() { return cloth_solvers_that_are_explicit(false); }

class SelfContact : public testing::TestWithParam<std::string> {
 protected:
  /// A tower of blocks that stand on each other, none right above the other.
  std::unique_ptr<World> tower(int blocks, const ParameterText& solver_parameters) const {
    SolidScene scene;
    for (int k = 0; k < blocks; ++k) {
      scene.parts.push_back(
          block_at({0.007 * k, 0.004 * k, 0.042 * k}, {{0.06, 0.06, 0.04}, {3, 3, 2}}));
    }
    scene.effects = {{"gravity", {}}, {"damping", {{"rate", "20"}}}, {"self_contact", {}}};
    scene.fixed = feet(scene);
    scene.solver = GetParam();
    scene.solver_parameters = solver_parameters;
    return make_solid_world(scene);
  }
};

INSTANTIATE_TEST_SUITE_P(Solvers, SelfContact, testing::ValuesIn(implicit_solvers()), test_name_of);

TEST_P(SelfContact, ABlockCarriesTheOneOnIt) {
  auto world = tower(2, {{"iterations", "200"}, {"tolerance", "1e-6"}});
  run_for(*world, 0.35);
  const double weight = 9.81 * mass_of(*world, 1);
  // What swings still, at rates of some 1/s times 1e-3 m, is 1e-3 of the weight.
  EXPECT_LE((force_on(*world, 1) - Eigen::Vector3d(0, 0, weight)).norm(), 2e-3 * weight);
  EXPECT_LE((force_on(*world, 0) + force_on(*world, 1)).norm(), 1e-13 * weight);
  EXPECT_LT(deepest_overlap(*world), 0.0);
  EXPECT_EQ(body_of(*world).report.contacts,
            effect_of<SelfContactEffect>(*world, "self_contact").active());
}

TEST_P(SelfContact, ATowerStays) {
  auto world = tower(3, {{"tolerance", "1e-4"}});
  run_for(*world, 0.5);
  const Positions settled = part_positions(*world, 2);
  run_for(*world, 0.5);
  EXPECT_LT(deepest_overlap(*world), 0.0);
  // 0.3 mm of 60 mm, in half a second.
  EXPECT_LE((part_positions(*world, 2) - settled).colwise().norm().maxCoeff(), 3e-4);
}

/// A block that flies at another.
SolidScene impact(const std::string& solver) {
  SolidScene scene;
  scene.parts = {block_at({0, 0, 0}, {{0.06, 0.06, 0.04}, {3, 3, 2}}),
                 block_at({0.013, 0.007, 0.05}, {{0.05, 0.05, 0.04}, {2, 2, 2}})};
  scene.effects = {{"self_contact", {}}};
  scene.solver = solver;
  scene.solver_parameters = {{"iterations", "200"}, {"tolerance", "1e-9"}};
  return scene;
}

void throw_at(World& world, const Eigen::Vector3d& velocity) {
  const SolidModel& model = solid_of(world);
  particles_of(world).v.rightCols(model.count(1)).colwise() = velocity;
  world.set_initial_state();
}

TEST_P(SelfContact, ForcesArePairs) {
  auto world = make_solid_world(impact(GetParam()));
  throw_at(*world, {0.3, 0.0, -1.5});
  double largest = 0.0;
  const double dt = world->time_step();
  for (int step = 0; step < 60; ++step) {
    ASSERT_TRUE(world->step()) << world->failure();
    const Forces f = contact_forces(*world);
    const Positions& x = particles_of(*world).x;
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
    for (int i = 0; i < x.cols(); ++i) torque += x.col(i).cross(f.col(i));
    double sum = 0.0;
    for (const PairContact& contact :
         effect_of<SelfContactEffect>(*world, "self_contact").contacts()) {
      sum += contact.normal_force + contact.friction_force.norm();
    }
    largest = std::max(largest, sum);
    EXPECT_LE(f.rowwise().sum().norm(), 1e-13 * sum);
    // Both forces act at one place where contacts were found. In the step the surfaces part there
    // by what solvers move against the prediction: less than the speed of 1.5 m/s.
    EXPECT_LE(torque.norm(), 1.6 * dt * sum);
    EXPECT_LT(deepest_overlap(*world), 1e-4);
  }
  EXPECT_GT(largest, 1.0);
}

TEST_P(SelfContact, AnImpactKeepsMomentum) {
  auto world = make_solid_world(impact(GetParam()));
  throw_at(*world, {0.3, 0.0, -1.5});
  const Eigen::Vector3d before = particles_of(*world).momentum();
  run_for(*world, 0.3);
  // Solvers that move each particle by its own share keep it as far as they converge.
  const double allowed = keeps_momentum(GetParam()) ? 1e-3 : 0.03;
  EXPECT_LE((particles_of(*world).momentum() - before).norm(), allowed * before.norm());
  const SolidModel& model = solid_of(*world);
  EXPECT_GT(particles_of(*world).v.leftCols(model.count(0)).row(2).mean(), -1.5);
  EXPECT_LT(particles_of(*world).v.leftCols(model.count(0)).row(2).mean(), -0.3) << "no impact";
}

TEST_P(SelfContact, ADeepOverlapOpensAtABoundedSpeed) {
  SolidScene scene;
  scene.parts = {block_at({0, 0, 0}, {{0.1, 0.1, 0.1}, {4, 4, 4}}, {1e5, 0.3, 1000.0}),
                 block_at({0.01, 0.005, 0.06}, {{0.1, 0.1, 0.1}, {4, 4, 4}}, {1e5, 0.3, 1000.0})};
  scene.effects = {{"damping", {{"rate", "5"}}}, {"self_contact", {}}};
  scene.solver = GetParam();
  scene.solver_parameters = {};
  auto world = make_solid_world(scene);
  EXPECT_GT(deepest_overlap(*world), 0.002);
  for (int step = 0; step < 30; ++step) {
    ASSERT_TRUE(world->step()) << world->failure();
    // Pushed out at 1 m/s, relative to each other.
    ASSERT_LE(particles_of(*world).v.colwise().norm().maxCoeff(), 2.0);
  }
  EXPECT_LT(deepest_overlap(*world), 0.0);
}

/// A small block on a fixed one, with gravity that leans by `degrees`.
SolidScene incline(const std::string& solver, double degrees) {
  SolidScene scene;
  scene.parts = {
      block_at({0, 0, -0.02}, {{0.3, 0.08, 0.04}, {6, 2, 1}}),
      block_at({0.003, 0.001, 0.022}, {{0.04, 0.04, 0.04}, {2, 2, 2}}, {1e5, 0.3, 1000.0})};
  const double angle = degrees * M_PI / 180.0;
  scene.effects = {{"gravity",
                    {{"acceleration", fmt::format("[{}, 0, {}]", 9.81 * std::sin(angle),
                                                  -9.81 * std::cos(angle))}}},
                   {"self_contact", {{"friction", "0.5"}}}};
  for (int i = 0; i < scene.parts[0].rest.vertices.cols(); ++i) scene.fixed.push_back(i);
  scene.solver = solver;
  scene.solver_parameters = {{"iterations", "300"}, {"tolerance", "1e-6"}};
  return scene;
}

TEST_P(SelfContact, FrictionHoldsUpToItsAngle) {
  // tan 26.6 degrees = 0.5.
  auto world = make_solid_world(incline(GetParam(), 20.0));
  run_for(*world, 0.1);
  const Eigen::Vector3d settled = part_positions(*world, 1).rowwise().mean();
  run_for(*world, 0.2);
  // A slide at this angle's excess without friction would be 50 mm.
  EXPECT_LE((part_positions(*world, 1).rowwise().mean() - settled).norm(), 5e-4);
}

TEST_P(SelfContact, FrictionSlowsBeyondItsAngle) {
  const double angle = 40.0 * M_PI / 180.0;
  auto world = make_solid_world(incline(GetParam(), 40.0));
  run_for(*world, 0.2);
  const double speed = particles_of(*world).v.row(0).tail(solid_of(*world).count(1)).mean();
  // The block swings on its contacts: 1 % of the speed.
  EXPECT_NEAR(speed, 0.2 * 9.81 * (std::sin(angle) - 0.5 * std::cos(angle)), 0.01);
}

/// A block with a slot from above, 60 mm wide.
TetrahedralMesh u_shape() {
  const TetrahedralMesh block = make_block({{0.18, 0.04, 0.1}, {9, 2, 5}});
  std::vector<int> numbers(static_cast<std::size_t>(block.vertices.cols()), -1);
  TetrahedralMesh mesh{Eigen::Matrix3Xd(3, 0), Eigen::Matrix4Xi(4, 0)};
  for (const auto t : block.tetrahedra.colwise()) {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (int i : t) center += 0.25 * block.vertices.col(i);
    if (std::abs(center[0]) < 0.03 && center[2] > -0.03) continue;
    mesh.tetrahedra.conservativeResize(4, mesh.tetrahedra.cols() + 1);
    for (int k = 0; k < 4; ++k) {
      int& number = numbers[static_cast<std::size_t>(t[k])];
      if (number < 0) {
        number = static_cast<int>(mesh.vertices.cols());
        mesh.vertices.conservativeResize(3, number + 1);
        mesh.vertices.col(number) = block.vertices.col(t[k]);
      }
      mesh.tetrahedra(k, mesh.tetrahedra.cols() - 1) = number;
    }
  }
  return mesh;
}

/// How far the inner side of the left arm gets beyond that of the right one within 0.15 s of
/// both being thrown at each other [m].
double farthest_fold(const std::string& solver, bool with_contact) {
  SolidScene scene;
  scene.parts = {{u_shape(), Eigen::Isometry3d::Identity(), {1e4, 0.3, 1000.0}}};
  if (with_contact) scene.effects = {{"self_contact", {}}};
  scene.solver = solver;
  scene.solver_parameters = {};
  auto world = make_solid_world(scene);
  const Positions& rest = scene.parts[0].rest.vertices;
  Particles& particles = particles_of(*world);
  for (int i = 0; i < particles.size(); ++i) {
    if (rest(2, i) > -0.02) particles.v(0, i) = rest(0, i) < 0.0 ? 1.0 : -1.0;
  }
  double farthest = -INFINITY;
  for (int step = 0; step < 30; ++step) {
    EXPECT_TRUE(world->step()) << world->failure();
    double left = 0.0, right = 0.0;
    int count = 0;
    for (int i = 0; i < particles.size(); ++i) {
      // Not the rim: its edges may cross between their vertices.
      if (rest(2, i) < 0.0 || rest(2, i) > 0.04) continue;
      if (std::abs(std::abs(rest(0, i)) - 0.03) > 1e-6) continue;
      (rest(0, i) < 0.0 ? left : right) += particles.x(0, i);
      ++count;
    }
    farthest = std::max(farthest, (left - right) / (0.5 * count));
  }
  return farthest;
}

TEST_P(SelfContact, AFoldedBodyDoesNotPassThroughItself) {
  EXPECT_GT(farthest_fold(GetParam(), false), 0.005) << "the arms never met";
  EXPECT_LT(farthest_fold(GetParam(), true), 0.0);
}

}  // namespace
}  // namespace pliant::self_contact_test
