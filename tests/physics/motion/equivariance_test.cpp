// A body that is turned, moved or mirrored with all that acts on it moves in the same way, turned,
// moved or mirrored: no solver knows of axes.
#include <gtest/gtest.h>

#include "support/random.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/solids.h"

namespace pliant::equivariance_test {
namespace {

struct Motion {
  std::string name;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // or mirror
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
};

std::vector<Motion> motions() {
  Random random(31);
  Eigen::Matrix3d quarter, mirror, skew_mirror;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  mirror = Eigen::Vector3d(-1, 1, 1).asDiagonal();
  const Eigen::Vector3d n = random.vector(1.0).normalized();
  skew_mirror = Eigen::Matrix3d::Identity() - 2.0 * n * n.transpose();
  return {{"quarter_turn", quarter},
          {"any_turn", random.rotation()},
          {"shift", Eigen::Matrix3d::Identity(), {0.5, -0.25, 1.0}},
          {"turn_and_shift", random.rotation(), {-0.3, 0.6, 0.1}},
          {"mirror", mirror},
          {"any_mirror", skew_mirror}};
}

/// Springs, a bending sheet or tetrahedra, as `motion` puts them.
ProjectiveSystem moved_body(const std::string& kind, const Motion& motion) {
  const auto place = [&](const Positions& x) -> Positions {
    return (motion.turn * x).colwise() + motion.shift;
  };
  ProjectiveSystem system;
  if (kind == "springs" || kind == "soft_springs") {
    system = spring_net(40, 2, kind == "springs" ? 300.0 : 3.0, 1.0);
    system.particles.fix(3);
  } else if (kind == "sheet") {
    TriangleMesh mesh = make_grid({0.2, 0.2, 7, 7});
    mesh.vertices = place(mesh.vertices);
    system = bending_sheet(mesh, 1e-3);
    system.particles.x = make_grid({0.2, 0.2, 7, 7}).vertices;
  } else {
    TetrahedralMesh mesh = jittered_block({{0.2, 0.1, 0.1}, {4, 2, 2}}, 0.2);
    const Positions rest = mesh.vertices;
    mesh.vertices = place(rest);
    fix_winding(mesh);
    system = system_at(rest, 0.01);
    system.elements = make_solid(mesh, {1e5, 0.3, 1000.0});
    system.particles.fix(0);
  }
  Particles& p = system.particles;
  Random random(17);
  p.v = motion.turn * random.positions(p.size(), 0.5);
  for (int i = 0; i < p.size(); ++i) {
    if (p.is_fixed(i)) p.v.col(i).setZero();
  }
  p.x = place(p.x);
  system.external_forces = motion.turn * random.positions(p.size(), 0.1);
  return system;
}

class Equivariance : public testing::TestWithParam<std::tuple<std::string, std::string>> {};
INSTANTIATE_TEST_SUITE_P(
    All, Equivariance,
    testing::Combine(testing::Values("soft_springs", "springs", "sheet", "solid"),
                     testing::ValuesIn(solver_registry().names())),
    [](const auto& info) { return std::get<0>(info.param) + "_" + std::get<1>(info.param); });

TEST_P(Equivariance, HoldsForEveryMotion) {
  const auto& [kind, solver] = GetParam();
  const double dt = solver == "verlet" ? 2e-4 : 0.01;
  const ParameterText parameters = with_iterations(solver, 12);
  constexpr int kSteps = 5;
  const auto run = [&](const Motion& motion) {
    ProjectiveSystem system = moved_body(kind, motion);
    const auto made = make_solver(solver, parameters);
    made->prepare(system, dt);
    for (int k = 0; k < kSteps; ++k) step_of(system, *made, dt);
    return system;
  };
  const ProjectiveSystem here = run({});
  EXPECT_GT((here.particles.x - here.particles.x_start).norm(), 1e-4);
  // Positions of about 1 m round by 1e-16 m in each of 60 updates, and no update amplifies what is
  // off already. The radius that Chebyshev estimates is a ratio of changes that have become small,
  // 1e-8 m: it is off by 1e-8, which moves the answer by as much of the error that is left.
  const double tolerance = solver == "chebyshev" ? 1e-10 : 2e-14;
  for (const Motion& motion : motions()) {
    const ProjectiveSystem there = run(motion);
    const Positions expected = (motion.turn * here.particles.x).colwise() + motion.shift;
    EXPECT_LE((there.particles.x - expected).cwiseAbs().maxCoeff(), tolerance) << motion.name;
    EXPECT_LE((there.particles.v - motion.turn * here.particles.v).cwiseAbs().maxCoeff(),
              tolerance / dt)
        << motion.name;
  }
}

}  // namespace
}  // namespace pliant::equivariance_test
