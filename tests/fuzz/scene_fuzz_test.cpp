#include <gtest/gtest.h>

#include <random>

#include "pliant/math/error.h"
#include "pliant/scene/scene.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

constexpr int kCases = 1000;
constexpr double kMaxBuiltVertices = 10'000;  // a mutation may ask for millions; that takes long

using Random = std::mt19937;

std::size_t pick(Random& random, std::size_t count) {
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
}

const std::vector<std::string>& nasty() {
  static const std::vector<std::string> texts = {"nan",
                                                 ".inf",
                                                 "-1",
                                                 "0",
                                                 "1e308",
                                                 "-1e-320",
                                                 "999999999999999999999",
                                                 "0x10",
                                                 "[]",
                                                 "{}",
                                                 "[[[[",
                                                 "}}}}",
                                                 "~",
                                                 "null",
                                                 "''",
                                                 "\"",
                                                 "&a",
                                                 "*a",
                                                 "!!int",
                                                 "|",
                                                 ">",
                                                 "- ",
                                                 ": ",
                                                 "\n",
                                                 "\t",
                                                 "#",
                                                 "---\n",
                                                 "? ",
                                                 "<<: ",
                                                 "include: scene.yaml\n",
                                                 "%YAML 9\n",
                                                 "true",
                                                 "cloth",
                                                 "mesh",
                                                 "package://pliant/x",
                                                 std::string(1, '\0'),
                                                 "\xff",
                                                 "\xe2\x82\xac",
                                                 "1 2 3",
                                                 ",,",
                                                 "@",
                                                 "`"};
  return texts;
}

/// Another number instead of one of the text's: it stays YAML and reaches deeper.
void mutate_number(Random& random, std::string& text) {
  static const std::vector<std::string> numbers = {"0",   "1",    "2",    "3",    "0.5",  "0.01",
                                                   "7",   "1e-9", "1e-3", "50",   "-0.5", "-1",
                                                   "1e3", "1e6",  "1e12", "1e30", "nan",  "0.003"};
  const char* digits = "0123456789";
  std::size_t begin = text.find_first_of(digits, pick(random, text.size()));
  if (begin == std::string::npos) begin = text.find_first_of(digits);
  if (begin == std::string::npos) return;
  const std::size_t end = text.find_first_not_of("0123456789.e-", begin);
  text.replace(begin, end == std::string::npos ? end : end - begin,
               numbers[pick(random, numbers.size())]);
}

void mutate_text(Random& random, std::string& text) {
  const std::size_t at = pick(random, text.size() + 1);
  const std::size_t length = std::min(pick(random, 20), text.size() - at);
  switch (pick(random, 6)) {
    case 0:
      text.erase(at, length);
      break;
    case 1:
      text.insert(at, nasty()[pick(random, nasty().size())]);
      break;
    case 2:
      text.replace(at, length, nasty()[pick(random, nasty().size())]);
      break;
    case 3:
      text.insert(at, text.substr(pick(random, text.size() + 1), 40));
      break;
    case 4:
      if (at < text.size()) text[at] = static_cast<char>(pick(random, 256));
      break;
    default:
      text.resize(at);
  }
}

/// Half of the seeds change numbers only.
void mutate(Random& random, std::string& text, int seed) {
  const std::size_t mutations = 1 + pick(random, 4);
  for (std::size_t i = 0; i < mutations && !text.empty(); ++i) {
    if (seed % 2 == 0) {
      mutate_number(random, text);
    } else {
      mutate_text(random, text);
    }
  }
}

double count_vertices(const SceneSpec& spec) {
  double vertices = 0.0;
  for (const BodySpec& body : spec.bodies) {
    const auto& grid = body.geometry.grid;
    if (grid) vertices += static_cast<double>(grid->columns) * grid->rows;
  }
  return vertices;
}

/// Loads and steps `path` and says whether it was accepted. InputError is the only way to refuse.
bool try_scene(const std::string& path) {
  try {
    SceneSpec spec = read_scene(path);
    // A million iterations are legal and take long.
    if (spec.solver.name == "xpbd") spec.solver.parameters["budget"] = "10";
    if (count_vertices(spec) > kMaxBuiltVertices) return true;
    const std::unique_ptr<World> world = build_world(spec);
    if (world->step()) {
      for (const Body& body : world->bodies()) EXPECT_TRUE(body.particles().x.allFinite());
    }
    return true;
  } catch (const InputError& error) {
    EXPECT_FALSE(std::string(error.what()).empty());
    return false;
  }
}

TEST(SceneFuzz, MutatedScenesAreReadOrRefused) {
  const SceneFiles files;
  const std::string scene = write_scene(files, kFullScene);
  int accepted = 0;
  for (int seed = 0; seed < kCases; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<Random::result_type>(seed));
    std::string text = kFullScene;
    mutate(random, text, seed);
    files.write("scene.yaml", text);
    accepted += try_scene(scene) ? 1 : 0;
  }
  // Both ways are really tried.
  EXPECT_GT(accepted, kCases / 50);
  EXPECT_LT(accepted, kCases / 2);
}

TEST(SceneFuzz, MutatedRobotsAreReadOrRefused) {
  const SceneFiles files;
  const std::string scene = write_scene(files, kFullScene);
  for (int seed = 0; seed < kCases / 4; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<Random::result_type>(seed));
    std::string urdf = kLiftUrdf, motion = kLiftMotion;
    mutate(random, urdf, seed);
    mutate(random, motion, seed / 2);
    files.write("robot.urdf", seed % 3 == 0 ? kLiftUrdf : urdf);
    files.write("motion.yaml", motion);
    try_scene(scene);
  }
}

}  // namespace
}  // namespace pliant
