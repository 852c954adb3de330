// How blocks of a packed system share work: none of it changes what an iteration finds.
#include <gtest/gtest.h>

#include "cuda/core/host_executor.h"
#include "cuda/solvers/device_step.h"
#include "cuda/solvers/scenes/joined_system.h"
#include "pliant/core/system/system.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

/// Launches each iteration on its own.
struct LaunchByLaunch : HostExecutor {
  template <class F>
  static bool fits_persistent(int, int, int, const F&) {
    return false;
  }
};

constexpr int kBlock = 32;
constexpr double kQuantum = 1.0 / (1 << 26);

/// Displacements of all places in one step of each scene, prediction as the system is.
template <class Executor>
std::vector<Float4> displacements(const PackedSystem& packed,
                                  const std::vector<const StepProblem*>& scenes,
                                  const std::vector<const ProjectiveSystem*>& systems,
                                  int iterations) {
  DeviceStep<Executor> step(packed);
  const auto places = static_cast<std::size_t>(packed.blocks * packed.block);
  std::vector<float> mobility(places, 0.0f);
  std::vector<Fixed> y(places, Fixed{0, 0, 0, 0.0f});
  std::vector<StepRules> rules;
  for (std::size_t s = 0; s < systems.size(); ++s) {
    const Particles& particles = systems[s]->particles;
    const double dt = scenes[s]->dt;
    AbsoluteRowSums sums(particles.size());
    for (const auto& set : systems[s]->elements) set->add_to_system(sums);
    const PackedSystem alone = pack(*systems[s], kBlock);
    const auto first = static_cast<std::size_t>(packed.scene_begins[s] * packed.block);
    for (std::size_t k = 0; k < alone.order.size(); ++k) {
      const int i = alone.order[k];
      const double inertia = particles.mass[i] / (dt * dt);
      const Eigen::Vector3d at = particles.x.col(i) / kQuantum;
      y[first + k] = {static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2]),
                      static_cast<float>(inertia)};
      if (!particles.is_fixed(i)) {
        mobility[first + k] = static_cast<float>(1.0 / (inertia + sums.sums()[i]));
      }
    }
    StepRules rule;
    rule.quantum = static_cast<float>(kQuantum);
    rule.particles = particles.size();
    rule.is_accelerated = true;
    rule.rho = 0.9;
    rule.rho_bound = 0.999;
    rule.delay = 3;
    rules.push_back(rule);
  }
  const auto count = static_cast<std::size_t>(packed.particles);
  mobility.resize(count);
  y.resize(count);
  step.set_mobility(mobility);
  step.set_predicted(y);
  step.set_start(y);
  step.set_contacts(ContactTable());
  step.set_rules(rules);
  step.run(iterations);
  std::vector<Float4> result;
  step.displacement(result);
  return result;
}

bool is_same(const Float4* a, const Float4* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof(Float4)) == 0;
}

/// Those with springs, bending and simplices alone.
std::vector<StepProblem> problems() {
  std::vector<StepProblem> result;
  for (const StepProblem& problem : step_problems()) {
    const ProjectiveSystem system = problem.make();
    if (why_not_packed(system).empty() && pack(system, kBlock).clusters.size() == 0) {
      result.push_back(problem);
    }
  }
  return result;
}

class DeviceBlocks : public testing::TestWithParam<StepProblem> {};
INSTANTIATE_TEST_SUITE_P(Problems, DeviceBlocks, testing::ValuesIn(problems()), problem_name);

TEST_P(DeviceBlocks, KeepWhatTheyReadFromIterationToIteration) {
  const ProjectiveSystem system = GetParam().make();
  const PackedSystem packed = pack(system, kBlock);
  const auto one = displacements<LaunchByLaunch>(packed, {&GetParam()}, {&system}, 37);
  const auto other = displacements<HostExecutor>(packed, {&GetParam()}, {&system}, 37);
  ASSERT_EQ(one.size(), other.size());
  EXPECT_TRUE(is_same(one.data(), other.data(), one.size()));
}

TEST_P(DeviceBlocks, ComputeTheirSimplicesInTwoPasses) {
  const ProjectiveSystem system = GetParam().make();
  const PackedSystem once = pack(system, kBlock), twice = pack(system, kBlock, 2);
  if (once.most_slots > 0) {
    EXPECT_LT(twice.most_slots, once.most_slots);
  }
  const auto one = displacements<LaunchByLaunch>(once, {&GetParam()}, {&system}, 20);
  const auto other = displacements<LaunchByLaunch>(twice, {&GetParam()}, {&system}, 20);
  float travel = 0.0f, off = 0.0f;
  for (std::size_t k = 0; k < one.size(); ++k) {
    travel = std::max(travel, norm(one[k].xyz()));
    off = std::max(off, norm(one[k].xyz() - other[k].xyz()));
  }
  // Forces are added in another order: round-off of a few quanta, and of sums of single precision.
  EXPECT_LE(off, 1e-5f * travel + 4.0f * static_cast<float>(kQuantum));
}

TEST_P(DeviceBlocks, OfCopiesReadTheElementsOfOne) {
  const ProjectiveSystem system = GetParam().make();
  const PackedSystem alone = pack(system, kBlock);
  const PackedSystem joined = join({&alone, &alone, &alone});
  EXPECT_EQ(joined.shared_blocks, alone.blocks);
  EXPECT_EQ(joined.tetrahedra.size(), alone.tetrahedra.size());
  const StepProblem* problem = &GetParam();
  const auto one = displacements<HostExecutor>(alone, {problem}, {&system}, 20);
  const auto all = displacements<HostExecutor>(joined, {problem, problem, problem},
                                               {&system, &system, &system}, 20);
  for (int scene = 0; scene < 3; ++scene) {
    const auto first =
        static_cast<std::size_t>(joined.scene_begins[static_cast<std::size_t>(scene)] * kBlock);
    EXPECT_TRUE(is_same(one.data(), all.data() + first, one.size())) << "scene " << scene;
  }
}

TEST(DeviceBlocksOf, DifferentBodiesReadTheirOwn) {
  const std::vector<StepProblem> all = problems();
  const StepProblem &first = all.front(), &second = all.back();
  const ProjectiveSystem a = first.make(), b = second.make();
  const PackedSystem packed_a = pack(a, kBlock), packed_b = pack(b, kBlock);
  const PackedSystem joined = join({&packed_a, &packed_b});
  EXPECT_EQ(joined.shared_blocks, 0);
  const auto both = displacements<HostExecutor>(joined, {&first, &second}, {&a, &b}, 20);
  const auto one = displacements<HostExecutor>(packed_a, {&first}, {&a}, 20);
  const auto other = displacements<HostExecutor>(packed_b, {&second}, {&b}, 20);
  EXPECT_TRUE(is_same(one.data(), both.data(), one.size()));
  const auto begin = static_cast<std::size_t>(packed_a.blocks * kBlock);
  EXPECT_TRUE(is_same(other.data(), both.data() + begin, other.size()));
}

TEST(BlockBorders, NumbersSayWhoIsMeant) {
  const BlockBorders borders(4, {{1, 3, 9, 4, 9}, {}, {0, 8, 11}});
  EXPECT_EQ(borders.begins(), (std::vector<int>{0, 2, 2, 3}));
  EXPECT_EQ(borders.places(), (std::vector<int>{4, 9, 0}));
  EXPECT_EQ(borders.most(), 2);
  EXPECT_EQ(borders.number(0, 3), 3);
  EXPECT_EQ(borders.number(0, 4), 4);
  EXPECT_EQ(borders.number(0, 9), 5);
  EXPECT_EQ(borders.number(2, 11), 3);
  EXPECT_EQ(borders.number(2, 0), 4);
}

TEST(BlockBorders, RefuseWhatSixteenBitsCannotNumber) {
  std::vector<int> many(70000);
  for (std::size_t k = 0; k < many.size(); ++k) many[k] = static_cast<int>(k);
  EXPECT_THROW(BlockBorders(32, {many}), InputError);
}

}  // namespace
}  // namespace pliant
