#include "pliant/scene/yaml/scene_value.h"

#include <gtest/gtest.h>

#include "pliant/math/error.h"
#include "pliant/scene/scene.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

class SceneValues : public ::testing::Test {
 protected:
  SceneSpec read(const std::string& path, const std::string& text) const {
    return read_scene(scene_, nullptr, {{path, text, {"table.csv", 7}}});
  }
  void refused(const std::string& path, const std::string& text,
               const std::vector<std::string>& words) const {
    try {
      read(path, text);
      FAIL() << path << " was taken";
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.rfind("table.csv:7", 0), 0u) << message;
      for (const std::string& word : words) {
        EXPECT_NE(message.find(word), std::string::npos) << message;
      }
    }
  }
  SceneFiles files_;
  std::string scene_ = write_scene(files_, kFullScene);
};

TEST_F(SceneValues, StandInPlaceOfTheFilesOwn) {
  EXPECT_EQ(read("time_step", "0.25").time_step, 0.25);
  EXPECT_EQ(read("bodies[0].material.areal_density", "0.7")
                .bodies[0]
                .model.parameters.at("areal_density"),
            "0.7");
  EXPECT_EQ(read("solver.iterations", "77").solver.parameters.at("iterations"), "77");
  const SceneSpec moved = read("bodies[towel].position", "[1, 2, 3]");
  EXPECT_EQ(moved.bodies[0].world_from_body.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST_F(SceneValues, MayBeKeysThatTheFileLacks) {
  EXPECT_EQ(read("bodies[0].material.bending", "2e-5").bodies[0].model.parameters.at("bending"),
            "2e-5");
}

TEST_F(SceneValues, AreCheckedAsTheFilesOwnAreWithTheTablesPlace) {
  refused("bodies[0].material.areal_density", "-1", {"areal_density", "-1"});
  refused("bodies[0].material.areal_densty", "1", {"areal_densty", "did you mean 'areal_density'"});
  refused("time_stp", "1", {"time_stp", "time_step"});
}

TEST_F(SceneValues, RefusesPathsThatLeadNowhere) {
  refused("", "1", {"empty", "bodies[0]"});
  refused("bodies[1].position", "[0, 0, 0]", {"1 items"});
  refused("obstacles[bal].radius", "1", {"'bal'", "did you mean 'ball'"});
  refused("bodies[0", "1", {"']'"});
  refused("bodies[0]position", "1", {"'.'"});
  refused("bodies..x", "1", {"empty key"});
  refused("time_step.x", "1", {"no map"});
  refused("time_step[0]", "1", {"no list"});
  refused("time_step", "[", {"time_step"});
  refused("time_step", "1\nname: other", {"one value"});
}

TEST_F(SceneValues, ATableIsReadWithQuotes) {
  const std::string path = files_.write(
      "table.csv", "time_step,bodies[0].position\r\n0.1,\"[1, 2, 3]\"\n\n0.2,\"\"\"a\"\"\"\n");
  SceneTable table(path);
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table.paths()[1], "bodies[0].position");
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<SceneValue> first = table.next(), second = table.next();
    EXPECT_EQ(first[0].text, "0.1");
    EXPECT_EQ(first[1].text, "[1, 2, 3]");
    EXPECT_EQ(second[1].text, "\"a\"");
    EXPECT_EQ(second[1].path, "bodies[0].position");
    EXPECT_EQ(second[1].place.line, 4);
    table.rewind();
  }
  files_.write("table.csv", "time_step,bodies[0].position\n0.1,1\n");
  SceneTable changed(path);
  changed.next();
  EXPECT_THROW(changed.next(), InputError);
  EXPECT_TRUE(SceneTable(3).next().empty());
}

TEST_F(SceneValues, ABadTableIsRefusedWithItsLine) {
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      SceneTable table(files_.write("table.csv", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_NE(refusal("a,b\n1\n").find("table.csv:2: 1 cells"), std::string::npos);
  EXPECT_NE(refusal("a,a\n1,2\n").find("given twice"), std::string::npos);
  EXPECT_NE(refusal("a,b\n").find("no rows"), std::string::npos);
  EXPECT_NE(refusal("a\n\"1\n").find("not closed"), std::string::npos);
  EXPECT_NE(refusal("a\n1\n\xff\n").find("table.csv:3: this is not text"), std::string::npos);
  EXPECT_THROW(SceneTable(files_.path("none.csv")), InputError);
}

}  // namespace
}  // namespace pliant
