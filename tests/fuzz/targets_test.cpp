// Readers of files from elsewhere, with mutations of small good files and with what was found by
// scripts/fuzz and has to stay mended (tests/fuzz/corpus/TARGET/).
#include "fuzz/targets.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

namespace pliant {
namespace {

constexpr int kMutations = 100;  // of each target

class Bytes {
 public:
  explicit Bytes(unsigned seed) : random_(seed) {}

  std::string mutate(std::string bytes) {
    const std::size_t count = 1 + below(4);
    for (std::size_t k = 0; k < count && !bytes.empty(); ++k) once(bytes);
    return bytes;
  }

 private:
  std::size_t below(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }
  void once(std::string& bytes) {
    static const std::vector<std::string> words = {"\xff\xff\xff\xff",
                                                   "\xff\xff\xff\x7f",
                                                   std::string(4, '\0'),
                                                   "\x01",
                                                   "-1",
                                                   "4000000000",
                                                   "nan",
                                                   "1e999",
                                                   "<",
                                                   "[",
                                                   "{",
                                                   "\"",
                                                   "\n",
                                                   "99999999999999999999"};
    const std::size_t at = below(bytes.size()), length = 1 + below(16);
    switch (below(6)) {
      case 0:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, words[below(words.size())]);
        break;
      case 3: {
        const std::string& word = words[below(words.size())];
        bytes.replace(at, word.size(), word);
        break;
      }
      case 4:
        bytes.insert(at, bytes.substr(below(bytes.size()), 64));
        break;
      default:
        bytes.resize(at);
    }
  }

  std::mt19937 random_;
};

[[maybe_unused]] void PrintTo(const FuzzTarget& target, std::ostream* stream) {
  *stream << target.name;
}

class FuzzTargets : public testing::TestWithParam<FuzzTarget> {};

TEST_P(FuzzTargets, MutatedFilesAreReadOrRefused) {
  const FuzzTarget& target = GetParam();
  for (const std::string& seed : target.seeds) EXPECT_TRUE(target.read(seed)) << "a bad seed";
  int refused = 0;
  for (int k = 0; k < kMutations; ++k) {
    SCOPED_TRACE(k);
    Bytes bytes(static_cast<unsigned>(k));
    const std::size_t seed = static_cast<std::size_t>(k) % target.seeds.size();
    refused += target.read(bytes.mutate(target.seeds[seed])) ? 0 : 1;
  }
  EXPECT_GT(refused, kMutations / 50) << "hardly anything is checked";
}

TEST_P(FuzzTargets, WhatWasFoundStaysMended) {
  namespace fs = std::filesystem;
  const fs::path folder =
      fs::path(PLIANT_SOURCE_DIR) / "tests" / "fuzz" / "corpus" / GetParam().name;
  if (!fs::is_directory(folder)) return;
  for (const auto& entry : fs::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path());
    std::ostringstream bytes;
    bytes << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    GetParam().read(bytes.str());
  }
}

INSTANTIATE_TEST_SUITE_P(All, FuzzTargets, testing::ValuesIn(fuzz_targets()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace pliant
