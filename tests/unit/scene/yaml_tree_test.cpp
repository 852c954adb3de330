#include "pliant/scene/yaml/yaml_tree.h"

#include <gtest/gtest.h>

#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

TEST(YamlTree, KeepsOrderKindsAndLines) {
  const YamlNode root = parse_yaml("b: 1\na:\n  - x\n  - {y: }\n", "f.yaml");
  ASSERT_EQ(root.entries.size(), 2u);
  EXPECT_EQ(root.entries[0].key, "b");
  EXPECT_EQ(root.entries[1].key_place.text(), "f.yaml:2");
  const YamlNode& list = *root.find("a");
  ASSERT_EQ(list.kind, YamlNode::Kind::kList);
  EXPECT_EQ(list.items[0].text, "x");
  EXPECT_EQ(list.items[1].place().line, 4);
  EXPECT_EQ(list.items[1].find("y")->kind, YamlNode::Kind::kNull);
  EXPECT_EQ(root.find("c"), nullptr);
}

struct Refusal {
  const char* name;
  std::string text;
  std::vector<std::string> parts;
};

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

std::string many_keys(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "k" + std::to_string(i) + ": 1\n";
  return text;
}

class YamlRefusal : public ::testing::TestWithParam<Refusal> {};

TEST_P(YamlRefusal, NamesFileLineAndReason) {
  expect_refusal([] { parse_yaml(GetParam().text, "f.yaml"); }, GetParam().parts);
}

INSTANTIATE_TEST_SUITE_P(
    Texts, YamlRefusal,
    ::testing::Values(
        Refusal{"Empty", "", {"f.yaml:1", "empty"}},
        Refusal{"OnlyComments", "# nothing\n", {"f.yaml:1", "empty"}},
        Refusal{"Scalar", "hello", {"f.yaml:1", "'hello'", "a map"}},
        Refusal{"List", "- 1\n- 2\n", {"f.yaml:1", "a list", "a map"}},
        Refusal{"DuplicateKey", "a: 1\nb: 2\na: 3\n", {"f.yaml:3", "'a'", "line 1"}},
        Refusal{"DuplicateNested", "a: {b: 1, b: 2}\n", {"f.yaml:1", "'b'"}},
        Refusal{"Syntax", "a: [1, 2\nb: 3\n", {"f.yaml:", "not valid YAML"}},
        Refusal{"Tab", "a:\n\tb: 1\n", {"f.yaml:2", "not valid YAML"}},
        Refusal{"Anchor", "a: &x 1\n", {"f.yaml:1", "anchor", "include"}},
        Refusal{"Alias", "a: 1\nb: *x\n", {"f.yaml:2"}},
        Refusal{"Tag", "a: !!binary abc\n", {"f.yaml:1", "tags"}},
        Refusal{"SecondDocument", "a: 1\n---\nb: 2\n", {"f.yaml:3", "second document"}},
        Refusal{"ListAsKey", "? [1, 2]\n: 3\n", {"f.yaml:1", "key must be a word"}},
        Refusal{"NullKey", "a: 1\n? \n: 3\n", {"f.yaml:", "key"}},
        Refusal{"NullByte", std::string("a: 1\nb: \0", 9), {"f.yaml:2", "not text"}},
        Refusal{"EscapedControl", "a: \"x\\0y\"\n", {"f.yaml:1", "control character"}},
        Refusal{"BadUtf8", "a: \xff\xfe\n", {"f.yaml:1", "not text"}},
        Refusal{"CutUtf8", "a: \xe2\x82", {"f.yaml:1", "not text"}},
        Refusal{"DeepFlow", "a: " + repeated("[", 5000), {"f.yaml:1"}},
        Refusal{"DeepMaps", repeated("{a: ", 40) + repeated("}", 40), {"f.yaml:1", "deeper"}},
        Refusal{"ManyKeys", many_keys(1001), {"f.yaml:1001", "1000 keys"}}),
    [](const auto& info) { return info.param.name; });

TEST(YamlFile, RefusesWhatIsNoFile) {
  const SceneFiles files;
  expect_refusal([&] { read_yaml_file(files.path("none.yaml")); }, {"none.yaml", "no such file"});
  expect_refusal([&] { read_yaml_file(files.path("")); }, {"not a file"});
  files.write("long.yaml", std::string(kMaxYamlBytes + 1, '#'));
  expect_refusal([&] { read_yaml_file(files.path("long.yaml")); }, {"long.yaml", "longer than"});
}

}  // namespace
}  // namespace pliant
