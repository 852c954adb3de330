// A saved state may come from somebody else, or be damaged: what effects, element sets and solvers
// keep in it is taken or refused, and where it is refused nothing has changed.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pliant/core/checkpoint_file.h"
#include "pliant/math/error.h"
#include "pliant/scene/scene.h"

namespace pliant::damaged_state_test {
namespace {

struct Running {
  std::string scene;
  std::string solver;  // empty: the scene's own
  double until;        // [s]
};

void PrintTo(const Running& p, std::ostream* out) { *out << p.scene << p.solver; }

class DamagedState : public testing::TestWithParam<Running> {
 protected:
  static LoadedScene load() {
    SceneOverrides overrides;
    if (!GetParam().solver.empty()) overrides.solver = GetParam().solver;
    return load_scene(
        std::string(PLIANT_SOURCE_DIR) + "/config/scenes/" + GetParam().scene + ".yaml", overrides);
  }
};

// Together: attachments that wait, hold and are over, contacts and pairs with forces that are
// known, bubbles, water, melting clusters, a liquid, reduced bodies, estimates of the error.
INSTANTIATE_TEST_SUITE_P(
    Scenes, DamagedState,
    testing::Values(Running{"demo_cloth", "", 1.1}, Running{"sealed_cloth", "", 0.05},
                    Running{"jelly_gripped", "", 0.1}, Running{"three_patches", "", 0.1},
                    Running{"plucked_bridge", "", 0.1}, Running{"demo_reduced", "", 0.1},
                    Running{"honey_surfaces", "", 0.02}, Running{"demo_viscoelastic", "", 0.05}),
    [](const auto& info) { return info.param.scene; });

/// Of what a body or its solver keeps, one number of another value.
StateArchive with_another(StateArchive numbers, std::size_t place, double value) {
  std::vector<double> values;
  numbers.rewind();
  while (numbers.left() > 0) values.push_back(numbers.read());
  values[place] = value;
  numbers.clear();
  for (const double v : values) numbers.write(v);
  return numbers;
}

/// Places of numbers that may be counts and indices, and of some others.
std::vector<std::size_t> places(StateArchive numbers, std::size_t most, std::mt19937& random) {
  std::vector<std::size_t> whole, other;
  numbers.rewind();
  for (std::size_t k = 0; numbers.left() > 0; ++k) {
    const double value = numbers.read();
    // Zeros are mostly parts of vectors.
    (value == std::floor(value) && value != 0.0 ? whole : other).push_back(k);
  }
  std::vector<std::size_t> chosen;
  for (auto* all : {&whole, &other}) {
    std::shuffle(all->begin(), all->end(), random);
    all->resize(std::min(all->size(), most / 2));
    chosen.insert(chosen.end(), all->begin(), all->end());
  }
  return chosen;
}

TEST_P(DamagedState, IsTakenOrRefusedWhole) {
  const LoadedScene scene = load();
  World& world = *scene.world;
  while (world.time() < GetParam().until) ASSERT_TRUE(world.step()) << world.failure();
  const Checkpoint good = world.save();
  const std::string before = state_bytes({good, {}});
  std::mt19937 random(7);
  constexpr std::size_t kPlaces = 12;
  const double values[] = {-2.0, 0.5, 1e9, 1e300, std::numeric_limits<double>::quiet_NaN()};
  int refused = 0;
  for (std::size_t b = 0; b < good.bodies.size(); ++b) {
    for (StateArchive Checkpoint::BodyState::*kept :
         {&Checkpoint::BodyState::numbers, &Checkpoint::BodyState::learned}) {
      for (const std::size_t place : places(good.bodies[b].*kept, kPlaces, random)) {
        const double value = values[random() % std::size(values)];
        Checkpoint damaged = good;
        damaged.bodies[b].*kept = with_another(good.bodies[b].*kept, place, value);
        try {
          world.load(damaged);
          world.step();  // may fail, and is undone then
        } catch (const InputError&) {
          ++refused;
          EXPECT_EQ(state_bytes({world.save(), {}}) == before, true) << place << ": " << value;
        }
        world.load(good);
      }
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_EQ(state_bytes({world.save(), {}}) == before, true);
  EXPECT_TRUE(world.step()) << world.failure();
}

TEST_P(DamagedState, ThatEndsTooEarlyIsTakenOrRefusedWhole) {
  const LoadedScene scene = load();
  World& world = *scene.world;
  ASSERT_TRUE(world.step()) << world.failure();
  const Checkpoint good = world.save();
  const std::string before = state_bytes({good, {}});
  for (std::size_t b = 0; b < good.bodies.size(); ++b) {
    Checkpoint damaged = good;
    damaged.bodies[b].numbers.clear();
    try {
      world.load(damaged);
      world.step();
    } catch (const InputError&) {
      EXPECT_EQ(state_bytes({world.save(), {}}) == before, true);
    }
    world.load(good);
  }
  EXPECT_EQ(state_bytes({world.save(), {}}) == before, true);
}

}  // namespace
}  // namespace pliant::damaged_state_test
