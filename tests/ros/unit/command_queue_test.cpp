#include "pliant/ros/running/command_queue.h"

#include <gtest/gtest.h>

#include <thread>

namespace pliant {
namespace {

using Clock = CommandQueue::Clock;

/// Serves a queue until it is closed, as the simulation thread does.
class Server {
 public:
  explicit Server(CommandQueue& queue)
      : queue_(queue), thread_([this] {
          while (!queue_.closed()) {
            queue_.run_pending();
            queue_.wait_until(Clock::now() + std::chrono::seconds(1));
          }
        }) {}
  ~Server() {
    queue_.close();
    thread_.join();
  }

 private:
  CommandQueue& queue_;
  std::thread thread_;
};

TEST(CommandQueue, AnswersFromManyThreads) {
  CommandQueue queue;
  int sum = 0;  // of the server's thread only
  {
    Server server(queue);
    std::vector<std::thread> callers;
    for (int c = 0; c < 8; ++c) {
      callers.emplace_back([&] {
        for (int k = 0; k < 200; ++k) {
          const Answer answer = queue.call([&](const Reply& reply) {
            ++sum;
            reply->set_value({true, "done", 0.0});
          });
          EXPECT_TRUE(answer.success);
        }
      });
    }
    for (std::thread& caller : callers) caller.join();
  }
  EXPECT_EQ(sum, 1600);
}

TEST(CommandQueue, ExceptionBecomesTheAnswer) {
  CommandQueue queue;
  Server server(queue);
  const Answer answer = queue.call([](const Reply&) { throw std::runtime_error("too long"); });
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message, "too long");
}

TEST(CommandQueue, AnswerMayComeLater) {
  CommandQueue queue;
  Server server(queue);
  Reply kept;
  std::thread caller(
      [&] { EXPECT_EQ(queue.call([&](const Reply& reply) { kept = reply; }).message, "later"); });
  while (!queue.call([&](const Reply& reply) {
                 reply->set_value({kept != nullptr, "", 0.0});
               })
              .success) {
    std::this_thread::yield();
  }
  kept->set_value({true, "later", 0.0});
  caller.join();
}

TEST(CommandQueue, CloseAnswersThoseWhoWaitAndThoseWhoCome) {
  CommandQueue queue;
  std::thread caller([&] { EXPECT_FALSE(queue.call([](const Reply&) { FAIL(); }).success); });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  queue.close();
  caller.join();
  EXPECT_EQ(queue.call([](const Reply&) { FAIL(); }).message, "the node is shutting down");
}

TEST(CommandQueue, WaitEndsWithACommandOrInTime) {
  CommandQueue queue;
  const auto start = Clock::now();
  queue.wait_until(start + std::chrono::milliseconds(20));
  EXPECT_GE(Clock::now(), start + std::chrono::milliseconds(20));
  std::thread caller([&] { queue.call([](const Reply&) {}); });
  queue.wait_until(start + std::chrono::seconds(30));
  EXPECT_LT(Clock::now(), start + std::chrono::seconds(20));
  queue.close();
  caller.join();
}

}  // namespace
}  // namespace pliant
