// The V-cycle of lbfgs on a GPU, its kernels run by the CPU: that of Multigrid in single precision,
// and what contacts hold in it.
#include <gtest/gtest.h>

#include "cuda/core/host_executor.h"
#include "cuda/solvers/matrix/iteration_matrix.h"
#include "cuda/solvers/matrix/matrix_arrays.h"
#include "cuda/solvers/matrix/multigrid_cycle.h"
#include "cuda/solvers/matrix/quasi_newton_step.h"
#include "pliant/elements/cloth/bending_set.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/models/cloth/cloth_springs.h"
#include "pliant/solvers/iterations/lbfgs.h"
#include "support/random.h"
#include "support/solvers/device_solvers.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

constexpr double kStep = 0.005;

ProjectiveSystem cloth_system(int side) {
  const GridOptions grid{1.0, 1.0, side, side};
  const TriangleMesh mesh = make_grid(grid);
  ProjectiveSystem system;
  system.particles = Particles(mesh.vertices, 0.15 * vertex_areas(mesh));
  system.elements.push_back(std::make_unique<SpringSet>(
      "stretch", grid_stretch_springs(grid, {500.0, 500.0, 0.0}), system.particles.size()));
  system.elements.push_back(std::make_unique<BendingSet>(grid, 1e-5, 1e-5));
  return system;
}

/// What launch_cycle() works on, of one system.
class Cycle {
 public:
  explicit Cycle(const ProjectiveSystem& system, int launched_levels = 0)
      : prepared(prepare_iteration(system, kStep, kIteration)), packed(pack(system, 32)) {
    const Eigen::VectorXd inertia = system.particles.mass / (kStep * kStep);
    packed.matrix = pack_matrix(prepared, kIteration, inertia, packed);
    if (launched_levels > 0) {
      auto other = std::make_shared<PackedMultigrid>(*packed.matrix.multigrids.front().packed);
      other->bottom = launched_levels;
      packed.matrix.multigrids.front().packed = other;
    }
    const auto n = packed.order.size();
    for (std::size_t k = 0; k < n; ++k) {
      const int i = packed.order[k];
      predicted_.push_back({0, 0, 0, static_cast<float>(inertia[i])});
      mobility_.push_back(static_cast<float>(prepared.relaxation.mobility[i]));
    }
    for (auto* array : {&wanted_, &found_[0], &found_[1]}) array->resize(n);
    holds.assign(n, {0.0f, 0.0f, 0.0f, Hold::kFree});
    matrix_.bind(executor_, packed.matrix, packed.particles, packed.blocks);
    multigrid_.bind(executor_, packed.matrix.multigrids);
    rules_.gamma = prepared.relaxation.gamma;
    rules_.largest_eigenvalue = static_cast<float>(prepared.relaxation.largest_eigenvalue);
    rules_.least_eigenvalue =
        static_cast<float>(prepared.relaxation.largest_eigenvalue / Smoother::kRange);
    control_.done_at = -1;
  }

  /// B q.
  Positions of(const Positions& q, bool has_holds) {
    StepArrays arrays;
    arrays.particles = packed.particles;
    arrays.block = packed.block;
    arrays.predicted = predicted_.data();
    arrays.mobility = mobility_.data();
    arrays.rules = &rules_;
    arrays.control = &control_;
    QuasiNewtonView view;
    view.sweeps = Smoother::kSweeps;
    view.states = &state_;
    view.wanted = wanted_.data();
    view.found[0] = found_[0].data();
    view.found[1] = found_[1].data();
    view.holds = holds.data();
    BeginQuasiNewtonState{arrays, view}(0);
    for (std::size_t k = 0; k < holds.size(); ++k) {
      const Eigen::Vector3f v = q.col(packed.order[k]).cast<float>();
      const Float3 free = Hold::project(holds[k], {v[0], v[1], v[2]});
      wanted_[k] = with_w(free, 0.0f);
      found_[0][k] = with_w((state_.pull[0] * mobility_[k]) * free, 0.0f);
      found_[1][k] = {0.0f, 0.0f, 0.0f, 0.0f};
    }
    launch_cycle(executor_, 1, arrays, matrix_.view(), view, multigrid_, has_holds);
    Positions result(3, q.cols());
    for (std::size_t k = 0; k < holds.size(); ++k) {
      const Float4 z = found_[1][k];
      result.col(packed.order[k]) << z.x, z.y, z.z;
    }
    return result;
  }
  /// A x, in the directions that are free.
  Positions matrix_times(const Positions& x) const {
    Positions product;
    multiply(prepared.matrix, x, product);
    for (std::size_t k = 0; k < holds.size(); ++k) {
      auto v = product.col(packed.order[k]);
      const Float3 free = Hold::project(
          holds[k], {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])});
      v << free.x, free.y, free.z;
    }
    return product;
  }
  int launched_levels() const { return multigrid_.launched_levels(); }

  static inline const DeviceIteration kIteration = lbfgs_device_spec({}, 5).iteration;
  IterationMatrix prepared;
  PackedSystem packed;
  std::vector<Float4> holds;

 private:
  HostExecutor executor_;
  MatrixArrays<HostExecutor> matrix_;
  MultigridArrays<HostExecutor> multigrid_;
  StepRules rules_;
  StepControl control_ = {};
  QuasiNewtonState state_ = {};
  std::vector<Fixed> predicted_;
  std::vector<float> mobility_;
  std::vector<Float4> wanted_, found_[2];
};

double dot(const Positions& a, const Positions& b) { return a.cwiseProduct(b).sum(); }

/// The middle of the cloth lies on a ball; some of it sticks, a few particles are on an edge.
void hold_the_middle(const ProjectiveSystem& system, Cycle& cycle) {
  Random random(7);
  for (std::size_t k = 0; k < cycle.holds.size(); ++k) {
    const Eigen::Vector3d x = system.particles.x.col(cycle.packed.order[k]);
    if (x.norm() > 0.3) continue;
    const Eigen::Vector3f normal = Eigen::Vector3d(x[0], x[1], 0.5).normalized().cast<float>();
    const double kind = random(0.0, 1.0);
    cycle.holds[k] = {normal[0], normal[1], normal[2], Hold::kPlane};
    if (kind < 0.2) cycle.holds[k].w = Hold::kFixed;
    if (kind > 0.95) cycle.holds[k] = {1.0f, 0.0f, 0.0f, Hold::kLine};
    if (kind > 0.4 && kind < 0.6) cycle.holds[k].w = Hold::kFree;
  }
}

TEST(DeviceMultigrid, IsThatOfTheCpu) {
  std::vector<std::function<ProjectiveSystem()>> systems = {[] { return cloth_system(40); }};
  for (const StepProblem& problem : step_problems()) systems.push_back(problem.make);
  for (const auto& make : systems) {
    const ProjectiveSystem system = make();
    if (!why_not_packed(system).empty()) continue;
    Cycle cycle(system);
    Positions q = Random(2).positions(system.particles.size(), 1.0);
    for (int i = 0; i < system.particles.size(); ++i) {
      if (system.particles.is_fixed(i)) q.col(i).setZero();
    }
    const Positions found = cycle.of(q, false);
    EXPECT_EQ(cycle.of(q, true), found) << "contacts that hold nothing";
    Positions exact = q;
    cycle.prepared.multigrid->solve(exact);
    EXPECT_LE((found - exact).norm(), 1e-5 * exact.norm());
  }
}

TEST(DeviceMultigrid, WhatIsHeldStaysAndTheRestIsSymmetricAndPositive) {
  const ProjectiveSystem system = cloth_system(30);
  Cycle cycle(system);
  hold_the_middle(system, cycle);
  const int n = system.particles.size();
  const Positions a = Random(3).positions(n, 1.0), b = Random(4).positions(n, 1.0);
  const Positions of_a = cycle.of(a, true), of_b = cycle.of(b, true);
  EXPECT_NEAR(dot(a, of_b), dot(b, of_a), 1e-7 * a.norm() * of_b.norm());
  EXPECT_GT(dot(a, of_a), 0.0);
  const auto round_off = static_cast<float>(1e-6 * of_a.cwiseAbs().maxCoeff());
  int held = 0;
  for (std::size_t k = 0; k < cycle.holds.size(); ++k) {
    const Float4 hold = cycle.holds[k];
    const Eigen::Vector3f whole = of_a.col(cycle.packed.order[k]).cast<float>();
    const Float3 free = Hold::project(hold, {whole[0], whole[1], whole[2]});
    EXPECT_NEAR((Eigen::Vector3f(free.x, free.y, free.z) - whole).norm(), 0.0f, round_off);
    held += hold.w != Hold::kFree ? 1 : 0;
  }
  EXPECT_GT(held, 100);
}

/// Largest eigenvalue of B A in the directions that are free, by a power iteration.
double longest_step(const ProjectiveSystem& system, Cycle& cycle, bool has_holds) {
  Positions x = cycle.of(Random(5).positions(system.particles.size(), 1.0), true);
  double largest = 0.0;
  for (int k = 0; k < 30; ++k) {
    const Positions q = cycle.matrix_times(x / x.norm());
    x = cycle.of(q, has_holds);
    largest = x.norm();
  }
  return largest;
}

TEST(DeviceMultigrid, NoCycleGoesTooFarWhereParticlesAreHeld) {
  // Below 2 a plain step x = B q lowers ½ xᵀA x − qᵀx, whose minimum projective dynamics looks for.
  const ProjectiveSystem system = cloth_system(30);
  Cycle cycle(system);
  EXPECT_LT(longest_step(system, cycle, false), 1.01);
  hold_the_middle(system, cycle);
  EXPECT_LT(longest_step(system, cycle, true), 1.5);
  EXPECT_GT(longest_step(system, cycle, false), 2.0) << "of no harm anyway: it tests nothing";
}

TEST(DeviceMultigrid, ALaunchALevelDoesWhatABlockDoes) {
  const ProjectiveSystem system = cloth_system(40);
  const Positions q = Random(2).positions(system.particles.size(), 1.0);
  Cycle in_block(system);
  EXPECT_EQ(in_block.launched_levels(), 0);
  hold_the_middle(system, in_block);
  const Positions wanted = in_block.of(q, true);
  const auto levels = static_cast<int>(in_block.prepared.multigrid->levels().size()) - 1;
  ASSERT_GE(levels, 2);
  for (int launched = 1; launched < levels; ++launched) {
    Cycle cycle(system, launched);
    EXPECT_EQ(cycle.launched_levels(), launched);
    hold_the_middle(system, cycle);
    EXPECT_EQ(cycle.of(q, true), wanted);
  }
}

}  // namespace
}  // namespace pliant
