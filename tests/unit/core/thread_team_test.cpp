// Threads that take parts of one job after another: each part once, whoever is late.
#include "pliant/core/parallel/thread_team.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace pliant::thread_team_test {
namespace {

/// Runs a job whose parts call `part`(k).
template <class Part>
bool run(ThreadTeam& team, int parts, const Part& part) {
  const auto call = [](const void* context, int k) { (*static_cast<const Part*>(context))(k); };
  return team.run(parts, call, &part);
}

class TeamOf : public testing::TestWithParam<int> {};

TEST_P(TeamOf, EachPartOfEachJobIsDoneOnce) {
  ThreadTeam team(GetParam());
  for (const int parts : {1, 2, 3, 7, 64, 1000}) {
    for (int job = 0; job < 200; ++job) {
      // Not atomic: only one thread has a part, and the job is over when it is read.
      std::vector<int> calls(static_cast<std::size_t>(parts), 0);
      ASSERT_TRUE(run(team, parts, [&](int k) { ++calls[static_cast<std::size_t>(k)]; }));
      for (const int count : calls) ASSERT_EQ(count, 1);
    }
  }
}

TEST_P(TeamOf, ThreadsThatSleepAreWoken) {
  ThreadTeam team(GetParam());
  for (int job = 0; job < 5; ++job) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::vector<std::thread::id> who(static_cast<std::size_t>(4 * GetParam()));
    const auto wait = [&](int k) {
      who[static_cast<std::size_t>(k)] = std::this_thread::get_id();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    };
    ASSERT_TRUE(run(team, static_cast<int>(who.size()), wait));
    std::size_t others = 0;
    for (const auto id : who) others += id != std::this_thread::get_id() ? 1 : 0;
    EXPECT_EQ(others > 0, GetParam() > 1) << "job " << job;
  }
}

TEST_P(TeamOf, WhatAPartThrowsArrives) {
  ThreadTeam team(GetParam());
  for (int bad = 0; bad < 8; ++bad) {
    const auto part = [&](int k) {
      if (k == bad) throw std::runtime_error("part " + std::to_string(k));
    };
    try {
      run(team, 8, part);
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), "part " + std::to_string(bad));
    }
    EXPECT_TRUE(run(team, 8, [](int) {}));
  }
}

TEST_P(TeamOf, OneJobAtATime) {
  ThreadTeam team(GetParam());
  std::vector<int> refused(16, 0);
  ASSERT_TRUE(run(team, 16, [&](int k) {
    refused[static_cast<std::size_t>(k)] =
        run(team, 2, [](int) { ADD_FAILURE() << "a job within a job"; }) ? 0 : 1;
  }));
  for (const int was_refused : refused) EXPECT_EQ(was_refused, 1);
}

TEST_P(TeamOf, SeveralCallersTakeTurnsOrAreRefused) {
  ThreadTeam team(GetParam());
  std::vector<std::thread> callers;
  std::vector<int> wrong(3, 0);
  for (int caller = 0; caller < 3; ++caller) {
    callers.emplace_back([&, caller] {
      for (int job = 0; job < 300; ++job) {
        std::vector<int> calls(16, 0);
        const bool ran = run(team, 16, [&](int k) { ++calls[static_cast<std::size_t>(k)]; });
        for (const int count : calls) {
          wrong[static_cast<std::size_t>(caller)] += count != (ran ? 1 : 0) ? 1 : 0;
        }
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  for (const int count : wrong) EXPECT_EQ(count, 0);
}

INSTANTIATE_TEST_SUITE_P(Threads, TeamOf, testing::Values(1, 2, 3, 8));

}  // namespace
}  // namespace pliant::thread_team_test
