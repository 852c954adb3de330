#include "pliant/geometry/io/child_process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "pliant/math/error.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

std::string in_child(const std::function<std::string()>& work, const ChildLimits& limits = {}) {
  return in_child_process(limits, "mesh 'm.dae'", work);
}

TEST(ChildProcess, GivesBackWhatTheWorkReturns) {
  EXPECT_EQ(in_child([] { return std::string(); }), "");
  const std::string bytes(3'000'000, '\0');
  EXPECT_EQ(in_child([&] { return bytes; }), bytes);
  expect_refusal([] { in_child([]() -> std::string { throw InputError("m.dae:3: no"); }); },
                 {"m.dae:3: no"});
}

TEST(ChildProcess, ACrashIsARefusal) {
  const auto refused = [](const std::function<void()>& work, const std::string& why,
                          const ChildLimits& limits = {}) {
    const auto whole = [&] {
      work();
      return std::string("done");
    };
    expect_refusal([&] { in_child(whole, limits); }, {"mesh 'm.dae': cannot be read: ", why});
  };
  refused([] { std::raise(SIGKILL); }, "crashed (Killed)");
  refused([] { std::abort(); }, "crashed (Aborted)");
  refused([] { _exit(3); }, "gave up");
  refused([] { throw 1; }, "gave up");
  refused(
      [] {
        for (volatile bool is_endless = true; is_endless;) {
        }
      },
      "took more than 1 s", {1e9, 1});
  refused(
      [] {
        std::vector<std::string> all;
        for (;;) all.emplace_back(std::size_t{1} << 24, 'x');
      },
      "more than 0.2 GB", {2e8, 60});
}

TEST(ChildProcess, WritesNoFileAndChangesNothingHere) {
  const SceneFiles files;
  int number = 1;
  in_child([&] {
    number = 2;
    std::signal(SIGXFSZ, SIG_IGN);
    std::ofstream(files.path("a")) << "text" << std::flush;
    return std::string();
  });
  EXPECT_EQ(number, 1);
  EXPECT_TRUE(!std::filesystem::exists(files.path("a")) ||
              std::filesystem::is_empty(files.path("a")));
}

TEST(ChildProcess, SeveralThreadsMay) {
  std::vector<std::thread> threads;
  std::vector<std::string> results(8);
  for (std::size_t k = 0; k < results.size(); ++k) {
    threads.emplace_back([&results, k] {
      for (int round = 0; round < 5; ++round) {
        results[k] += in_child([k] { return std::string(100000, static_cast<char>('a' + k)); });
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t k = 0; k < results.size(); ++k) {
    EXPECT_EQ(results[k], std::string(500000, static_cast<char>('a' + k)));
  }
}

}  // namespace
}  // namespace pliant
