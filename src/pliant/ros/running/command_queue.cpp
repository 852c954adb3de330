#include "pliant/ros/running/command_queue.h"

namespace pliant {
namespace {

Answer shutting_down() { return {false, "the node is shutting down", 0.0}; }

void run(const CommandQueue::Command& command, const Reply& reply) {
  try {
    command(reply);
  } catch (const std::exception& error) {
    reply->set_value({false, error.what(), 0.0});
  }
}

}  // namespace

Answer CommandQueue::call(Command command) {
  const Reply reply = std::make_shared<std::promise<Answer>>();
  std::future<Answer> answer = reply->get_future();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return shutting_down();
    entries_.push_back({std::move(command), reply});
    pending_ = true;
  }
  changed_.notify_one();
  return answer.get();
}

void CommandQueue::run_pending() {
  if (!pending_) return;
  std::vector<Entry> entries;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    entries.swap(entries_);
    pending_ = false;
  }
  for (const Entry& entry : entries) run(entry.command, entry.reply);
}

void CommandQueue::wait_until(Clock::time_point time) {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_until(lock, time, [this] { return pending_ || closed_; });
}

void CommandQueue::close() {
  std::vector<Entry> refused;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    pending_ = false;
    refused.swap(entries_);
  }
  changed_.notify_one();
  for (const Entry& entry : refused) entry.reply->set_value(shutting_down());
}

}  // namespace pliant
