// Strains of edges and vertices, and the viscosity of strains: derivatives and laws of each set.
#include "pliant/elements/solids/averaged_tetrahedra.h"

#include <gtest/gtest.h>

#include <limits>

#include "pliant/elements/solids/fiber_set.h"
#include "pliant/elements/solids/tetrahedron_set.h"
#include "support/expect_refusal.h"
#include "support/solvers/matrices.h"
#include "support/worlds/solids.h"
#include "unit/elements/element_examples.h"

namespace pliant {
namespace {

constexpr LameParameters kLame{700.0, 500.0};

struct SetCase {
  std::string name;
  Positions rest;
  std::shared_ptr<ElementSet> set;
};

/// Elastic sets, and those that damp them, which remember a strained state.
std::vector<SetCase> all_sets() {
  std::vector<SetCase> cases;
  Random random(3);
  const auto add_damping = [&](const std::string& name, const Positions& rest,
                               const ElementSet& elastic) {
    std::vector<std::unique_ptr<ElementSet>> viscous;
    elastic.add_damping(0.004, viscous);
    EXPECT_FALSE(viscous.empty()) << name;
    const int n = static_cast<int>(rest.cols());
    Particles p(rest, Eigen::VectorXd::Ones(n));
    p.x_start = rest + random.positions(n, 0.02);
    for (auto& set : viscous) {
      set->prepare(0.002);
      set->begin_step(p);
      cases.push_back({name + " damping", rest, std::move(set)});
    }
  };
  const TetrahedralMesh mesh = example_block(2);
  for (auto& set : averaged_tetrahedra(mesh, kLame)) {
    add_damping("averaged", mesh.vertices, *set);
    cases.push_back({"averaged", mesh.vertices, std::move(set)});
  }
  add_damping("tetrahedra", mesh.vertices, TetrahedronSet(mesh, kLame));
  add_damping("fibres", mesh.vertices, FiberSet(mesh, 1000.0, Eigen::Vector3d(2.0, -1.0, 0.5)));
  const auto add_cloth = [&](const std::string& name, const ElementExample& example) {
    add_damping(name, example.rest, *example.set);
  };
  add_cloth("springs", make_example<SpringSet>(2));
  add_cloth("membrane", make_example<TriangleStrainSet>(2));
  add_cloth("bending", make_example<BendingSet>(2));
  const GridOptions grid = example_grid(2);
  add_damping("grid bending", make_grid(grid).vertices, BendingSet(grid, 2e-3, 1e-3));
  return cases;
}

Positions crumpled(const SetCase& one, Random& random) {
  return one.rest + random.positions(static_cast<int>(one.rest.cols()), 0.02);
}

TEST(StrainSets, ForceIsMinusTheGradientOfEnergy) {
  Random random(11);
  for (const SetCase& one : all_sets()) {
    const Positions x = crumpled(one, random);
    const Forces f = forces_of(*one.set, x);
    const double scale = f.cwiseAbs().maxCoeff(), h = 1e-6;
    EXPECT_GT(scale, 0.0) << one.name;
    for (int k = 0; k < x.size(); ++k) {
      Positions up = x, down = x;
      up.data()[k] += h;
      down.data()[k] -= h;
      const double slope = (one.set->energy(up) - one.set->energy(down)) / (2.0 * h);
      ASSERT_NEAR(f.data()[k], -slope, 1e-7 * scale + 1e-16 * one.set->energy(x) / h) << one.name;
    }
  }
}

TEST(StrainSets, StiffnessIsMinusTheGradientOfForce) {
  Random random(12);
  for (const SetCase& one : all_sets()) {
    Positions x = crumpled(one, random);
    // That of scalar strains is Gauss and Newton's: exact where nothing changed.
    const bool is_solid = one.name == "averaged" || one.name == "averaged damping" ||
                          one.name == "tetrahedra damping";
    if (!is_solid) {
      Particles p(one.rest, Eigen::VectorXd::Ones(one.rest.cols()));
      p.x_start = x;
      one.set->begin_step(p);
    }
    const Eigen::MatrixXd k = stiffness_of(*one.set, x);
    const Eigen::MatrixXd differences = stiffness_by_differences(*one.set, x, 1e-6);
    const double largest = k.cwiseAbs().maxCoeff();
    EXPECT_LE((k - differences).cwiseAbs().maxCoeff(), 1e-6 * largest) << one.name;
    EXPECT_LE((k - k.transpose()).cwiseAbs().maxCoeff(), 1e-12 * largest) << one.name;
    const Eigen::MatrixXd projected = stiffness_of(*one.set, x, Definiteness::kProjected);
    EXPECT_GE(least_eigenvalue(projected), -1e-10 * largest) << one.name;
    EXPECT_GE(least_eigenvalue(projected - k), -1e-10 * largest) << one.name;
    const int n = static_cast<int>(x.cols());
    if (!is_solid) continue;
    EXPECT_GE(least_eigenvalue(over_coordinates(system_of(*one.set, n)) - projected),
              -1e-10 * largest)
        << one.name;
  }
}

TEST(StrainSets, NoForceOrTorqueIsLeftOver) {
  Random random(13);
  for (const SetCase& one : all_sets()) {
    const Positions x = crumpled(one, random);
    const Forces f = forces_of(*one.set, x);
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
    for (int i = 0; i < x.cols(); ++i) torque += Eigen::Vector3d(x.col(i)).cross(f.col(i));
    const double size = f.cwiseAbs().sum();
    EXPECT_LE(f.rowwise().sum().norm(), 1e-13 * size) << one.name;
    EXPECT_LE(torque.norm(), 1e-13 * size) << one.name;
  }
}

TEST(StrainSets, RotationsAreNoStrainRate) {
  Random random(14);
  for (const SetCase& one : all_sets()) {
    if (!one.set->is_viscous()) continue;
    Particles p(one.rest, Eigen::VectorXd::Ones(one.rest.cols()));
    p.x_start = crumpled(one, random);
    one.set->begin_step(p);
    Positions turned = random.rotation() * p.x_start;
    turned.colwise() += random.vector(1.0);
    const double size = one.set->energy(crumpled(one, random));
    EXPECT_LE(one.set->energy(turned), 1e-20 * size) << one.name;
    EXPECT_GT(size, 0.0) << one.name;
  }
}

TEST(StrainSets, IntegrationsOfSecondOrderGoOnFromTheStepBefore) {
  // A strain that grows steadily by 1 has grown by 1 + share less from what is remembered.
  std::vector<std::unique_ptr<ElementSet>> viscous;
  SpringSet("stretch", {{0, 1, 1.0, 10.0}}, 2).add_damping(0.1, viscous);
  Positions x(3, 2);
  x << 0, 3, 0, 0, 0, 0;
  Particles p(x, Eigen::VectorXd::Ones(2));
  p.x_start = x;
  p.history_before.moved.setZero(3, 2);
  p.history_before.moved(0, 1) = 1.0;
  p.inertia.is_used = true;
  p.inertia.share = 1.0 / 3.0;
  viscous[0]->prepare(0.02);
  viscous[0]->begin_step(p);
  Positions end = x;
  end(0, 1) = 4.0;
  // 1/2 k β/h (4 − 3 − 1/3)²
  EXPECT_NEAR(viscous[0]->energy(end), 0.5 * 10.0 * 5.0 * 4.0 / 9.0, 1e-12);
}

TEST(AveragedTetrahedra, PatchTest) {
  // On any mesh a homogeneous state is one of equilibrium within, with the material's energy.
  const TetrahedralMesh mesh = jittered_block({{1.0, 0.8, 0.6}, {4, 3, 3}}, 0.2);
  const auto sets = averaged_tetrahedra(mesh, kLame);
  Random random(15);
  for (const double size : {1e-6, 0.3}) {
    Eigen::Matrix3d g = Eigen::Matrix3d::Identity();
    for (double& entry : g.reshaped()) entry += random(-size, size);
    const Positions x = random.rotation() * g * mesh.vertices;
    Forces f = Forces::Zero(3, x.cols());
    double energy = 0.0;
    for (const auto& set : sets) {
      set->add_forces(x, f);
      energy += set->energy(x);
    }
    const double scale = f.cwiseAbs().maxCoeff();
    int within = 0;
    for (int i = 0; i < x.cols(); ++i) {
      if (on_boundary(mesh, i)) continue;
      EXPECT_LE(f.col(i).norm(), 1e-9 * scale + 1e-13);
      ++within;
    }
    EXPECT_GT(within, 0);
    const double expected = TetrahedronSet(mesh, kLame).energy(x);
    EXPECT_NEAR(energy, expected, 1e-6 * expected);
  }
}

TEST(AveragedTetrahedra, PoissonsRatioZeroNeedsNoPressure) {
  const TetrahedralMesh mesh = example_block(2);
  EXPECT_EQ(averaged_tetrahedra(mesh, kLame).size(), 2u);
  EXPECT_EQ(averaged_tetrahedra(mesh, {0.0, 500.0}).size(), 1u);
}

TEST(AveragedTetrahedra, RefusesWhatTetrahedraRefuse) {
  const TetrahedralMesh mesh = example_block(2);
  EXPECT_THROW(averaged_tetrahedra(mesh, {1.0, 0.0}), InputError);
  EXPECT_THROW(averaged_tetrahedra(mesh, {-1.0, 1.0}), InputError);
  EXPECT_THROW(averaged_tetrahedra(mesh, {std::numeric_limits<double>::infinity(), 1.0}),
               InputError);
}

}  // namespace
}  // namespace pliant
