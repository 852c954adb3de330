#include "pliant/core/checkpoint_file.h"

#define XXH_INLINE_ALL
#include <gtest/gtest.h>
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr std::size_t kLine = 15;  // "Pliant state 6\n"
constexpr std::size_t kHead = kLine + sizeof(XXH64_hash_t);

/// Two bodies with everything that a state may have.
SavedState full_state() {
  SavedState state;
  state.checkpoint.time_step = 0.01;
  state.checkpoint.time = 0.25;
  state.checkpoint.steps = 25;
  for (const char* name : {"cloth", "jelly"}) {
    Checkpoint::BodyState body;
    body.name = name;
    body.particles = Particles(Positions::Random(3, 4), Eigen::VectorXd::Constant(4, 0.5));
    body.particles.fix(1);
    body.particles.inertia.is_used = true;
    body.particles.inertia.x = Positions::Random(3, 4);
    body.particles.history.moved = Eigen::Matrix3Xd::Random(3, 4);
    body.particles.history_before.reserve = 3.0;
    body.effects = {"gravity", "contact"};
    body.numbers.write(1.5);
    body.learned.write_all(Eigen::Vector3d(1, 2, 3));
    body.solver = "xpbd";
    body.effective_dt = 0.02;
    state.checkpoint.bodies.push_back(body);
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(1, 2, 3);
  state.checkpoint.obstacles.push_back({pose, Eigen::Isometry3d::Identity()});
  state.joints = {{0.1, 0.2}, {}};
  return state;
}

/// As a file that was made to mislead would have it.
std::string with_right_hash(std::string bytes) {
  const XXH64_hash_t hash = XXH3_64bits(bytes.data() + kHead, bytes.size() - kHead);
  std::memcpy(&bytes[kLine], &hash, sizeof hash);
  return bytes;
}

TEST(CheckpointFile, RefusesParticlesThatCannotBe) {
  const double kNaN = std::nan("");
  const std::vector<std::function<void(Particles&)>> damages = {
      [&](Particles& p) { p.x(1, 2) = kNaN; },
      [&](Particles& p) { p.v(0, 0) = std::numeric_limits<double>::infinity(); },
      [&](Particles& p) { p.mass[1] = -0.5; },
      [&](Particles& p) { p.mass[1] = kNaN; },
      [&](Particles& p) { p.inverse_mass[3] = -2.0; },
  };
  for (std::size_t k = 0; k < damages.size(); ++k) {
    SavedState state = full_state();
    damages[k](state.checkpoint.bodies[1].particles);
    EXPECT_THROW(state_of(state_bytes(state), "file"), InputError) << k;
  }
}

TEST(CheckpointFile, HoldsAllOfAState) {
  const SavedState state = full_state();
  const std::string bytes = state_bytes(state);
  const SavedState read = state_of(bytes, "file");
  EXPECT_EQ(state_bytes(read), bytes);
  EXPECT_EQ(read.checkpoint.steps, 25u);
  EXPECT_EQ(read.joints, state.joints);
  ASSERT_EQ(read.checkpoint.bodies.size(), 2u);
  const Checkpoint::BodyState &own = read.checkpoint.bodies[1],
                              &expected = state.checkpoint.bodies[1];
  EXPECT_EQ(own.name, "jelly");
  EXPECT_EQ(own.particles.x, expected.particles.x);
  EXPECT_EQ(own.particles.inverse_mass, expected.particles.inverse_mass);
  EXPECT_EQ(own.particles.inertia.x, expected.particles.inertia.x);
  EXPECT_EQ(own.particles.history.moved, expected.particles.history.moved);
  EXPECT_EQ(own.particles.history_before.reserve, 3.0);
  EXPECT_EQ(own.effects, expected.effects);
  EXPECT_EQ(own.effective_dt, 0.02);
  EXPECT_EQ(read.checkpoint.obstacles[0].start.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(CheckpointFile, RefusesWhatIsCutOffOrChanged) {
  const std::string bytes = state_bytes(full_state());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(state_of(bytes.substr(0, size), "file"), InputError) << size;
  }
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    std::string other = bytes;
    other[k] = static_cast<char>(other[k] ^ 4);
    EXPECT_THROW(state_of(other, "file"), InputError) << k;
  }
}

TEST(CheckpointFile, BelievesNoSizeThatTheBytesDoNotHave) {
  const std::string bytes = state_bytes(full_state());
  int refused = 0;
  for (std::size_t k = kHead; k + 8 <= bytes.size(); ++k) {
    for (const std::uint64_t size : {~std::uint64_t{0}, std::uint64_t{1} << 61, std::uint64_t{5}}) {
      std::string other = bytes;
      std::memcpy(&other[k], &size, sizeof size);
      try {
        state_of(with_right_hash(other), "file");  // another number, where no size was
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(CheckpointFile, RefusesParticlesThatLackNumbers) {
  for (const int part : {0, 1, 2, 3}) {
    SavedState state = full_state();
    Particles& p = state.checkpoint.bodies[0].particles;
    if (part == 0) p.v = Eigen::Matrix3Xd::Zero(3, 3);
    if (part == 1) p.mass = Eigen::VectorXd::Ones(5);
    if (part == 2) p.history.gained = Eigen::Matrix3Xd::Zero(3, 2);
    if (part == 3) p.inertia.x.resize(3, 0);
    EXPECT_THROW(state_of(state_bytes(state), "file"), InputError) << part;
  }
}

TEST(CheckpointFile, RefusesForcesThatAct) {
  SavedState state = full_state();
  AppliedForce force;
  force.duration = 1.0;
  state.checkpoint.applied_forces.add(force);
  EXPECT_THROW(state_bytes(state), InputError);
}

}  // namespace
}  // namespace pliant
