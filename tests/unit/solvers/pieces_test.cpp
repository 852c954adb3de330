// What errors are compared within: bodies, and all particles that nothing ties.
#include "pliant/solvers/components/pieces.h"

#include <gtest/gtest.h>

#include "pliant/elements/cloth/spring_set.h"
#include "support/solvers/solver_systems.h"

namespace pliant::pieces_test {
namespace {

/// Springs between some of the particles.
std::unique_ptr<SpringSet> springs(const std::vector<std::pair<int, int>>& pairs, int particles) {
  std::vector<Spring> all;
  for (const auto& [a, b] : pairs) all.push_back({a, b, 1.0, 100.0});
  return std::make_unique<SpringSet>("springs", all, particles);
}

/// Particles 0-1 and 3-4 tied by springs, 2 and 5 free, 6 pinned; masses 1, 2, ... 7 kg.
ProjectiveSystem seven_particles() {
  Positions x = Positions::Zero(3, 7);
  x.row(0) = Eigen::RowVectorXd::LinSpaced(7, 0.0, 6.0);
  ProjectiveSystem system = system_at(x, 1.0);
  for (int i = 0; i < 7; ++i) system.particles.mass[i] = i + 1.0;
  system.elements.push_back(springs({{0, 1}, {3, 4}}, 7));
  system.particles.fix(6);
  return system;
}

Pieces pieces_of(const ProjectiveSystem& system) {
  return Pieces(find_components(system), system.particles.mass);
}

TEST(Pieces, AreBodiesAndOneOfAllLooseParticles) {
  const ProjectiveSystem system = seven_particles();
  EXPECT_EQ(Pieces::of_particles(find_components(system)),
            (std::vector<int>{0, 0, 2, 1, 1, 2, Pieces::kNone}));
  const Pieces pieces = pieces_of(system);
  EXPECT_EQ(pieces.count(), 3);
  EXPECT_FALSE(pieces.are_one());
  EXPECT_DOUBLE_EQ(pieces.mass_share(0), 3.0 / 21.0);
  EXPECT_DOUBLE_EQ(pieces.mass_share(2), 9.0 / 21.0);
}

TEST(Pieces, SumWhatIsOnEach) {
  Eigen::VectorXd sums;
  pieces_of(seven_particles()).sum([](int i) { return i + 1.0; }, sums);
  EXPECT_EQ(sums, Eigen::Vector3d(3.0, 9.0, 9.0));
}

TEST(Pieces, ASingleBodyIsOne) {
  ProjectiveSystem system = system_at(Positions::Random(3, 2), 1.0);
  system.elements.push_back(springs({{0, 1}}, 2));
  EXPECT_TRUE(pieces_of(system).are_one());
}

TEST(Pieces, ALiquidIsOne) {
  const ProjectiveSystem system = system_at(Positions::Random(3, 5), 1.0);
  const Pieces pieces = pieces_of(system);
  EXPECT_TRUE(pieces.are_one());
  EXPECT_EQ(pieces.count(), 1);
}

}  // namespace
}  // namespace pliant::pieces_test
