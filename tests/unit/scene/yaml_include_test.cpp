#include "pliant/scene/yaml/yaml_include.h"

#include <gtest/gtest.h>

#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

YamlNode read_included(const std::string& path) { return read_yaml_with_includes(path, nullptr); }

TEST(YamlInclude, LaterKeysWinMapwise) {
  const SceneFiles files;
  files.write("base/a.yaml", "x: {p: 1, q: 2}\nl: [1, 2, 3]\n");
  files.write("base/b.yaml", "include: a.yaml\nx: {q: 3}\n");
  const YamlNode root =
      read_included(files.write("main.yaml", "include: [base/b.yaml]\nl: [9]\nx: {r: 4}\n"));
  const YamlNode& x = *root.find("x");
  EXPECT_EQ(x.find("p")->text, "1");
  EXPECT_EQ(x.find("q")->text, "3");
  EXPECT_EQ(x.find("r")->text, "4");
  EXPECT_EQ(root.find("l")->items.size(), 1u);
  EXPECT_EQ(root.find("include"), nullptr);
}

TEST(YamlInclude, ValuesRememberTheirFile) {
  const SceneFiles files;
  const std::string base = files.write("base.yaml", "\nx: 1\n");
  const std::string main = files.write("main.yaml", "include: base.yaml\ny: 2\n");
  const YamlNode root = read_included(main);
  EXPECT_EQ(root.find("x")->place().text(), base + ":2");
  EXPECT_EQ(root.find("y")->place().text(), main + ":2");
}

TEST(YamlInclude, ReadsOneFileTwiceWithoutCycle) {
  const SceneFiles files;
  files.write("base.yaml", "x: 1\n");
  files.write("left.yaml", "include: base.yaml\n");
  files.write("right.yaml", "include: base.yaml\nx: 2\n");
  EXPECT_EQ(
      read_included(files.write("m.yaml", "include: [right.yaml, left.yaml]\n")).find("x")->text,
      "1");
}

TEST(YamlInclude, RefusesCycles) {
  const SceneFiles files;
  files.write("a.yaml", "x: 1\ninclude: b.yaml\n");
  files.write("b.yaml", "include: ./a.yaml\n");
  expect_refusal([&] { read_included(files.path("a.yaml")); }, {"b.yaml:1", "includes itself"});
}

TEST(YamlInclude, RefusesMissingFilesAndWrongTypes) {
  const SceneFiles files;
  expect_refusal([&] { read_included(files.write("a.yaml", "x: 1\ninclude: none.yaml\n")); },
                 {"a.yaml:2: include", "none.yaml"});
  expect_refusal([&] { read_included(files.write("b.yaml", "include: {a: 1}\n")); },
                 {"b.yaml:1: include", "a map", "list of paths"});
  expect_refusal([&] { read_included(files.write("c.yaml", "include: []\n")); },
                 {"c.yaml:1", "empty list"});
  expect_refusal([&] { read_included(files.write("d.yaml", "include: [[]]\n")); },
                 {"d.yaml:1", "a text"});
  files.write("broken.yaml", "x: [\n");
  expect_refusal([&] { read_included(files.write("e.yaml", "include: broken.yaml\n")); },
                 {"broken.yaml:", "not valid YAML"});
}

TEST(YamlInclude, RefusesTooManyFiles) {
  const SceneFiles files;
  std::string name = "0.yaml";
  files.write(name, "x: 1\n");
  for (int i = 1; i < 8; ++i) {  // 2^8 files in all
    const std::string next = std::to_string(i) + ".yaml";
    files.write(next, "include: [" + name + ", " + name + "]\n");
    name = next;
  }
  expect_refusal([&] { read_included(files.path(name)); }, {"more than 64 files"});
}

}  // namespace
}  // namespace pliant
