#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "pliant/ros/notices.h"

namespace pliant {

/// Looks at the ROS master every second of wall time, in a thread of its own: registers this node
/// again with a master that came back and knows nothing of it, and tells of a second publisher of
/// /clock. Connections that are there go on meanwhile.
class MasterWatch {
 public:
  /// `services`: resolved names of the node's own. `notices` outlives this; it hears of what is
  /// wrong, as the log does once.
  MasterWatch(std::vector<std::string> services, bool publishes_clock, Notices& notices);
  ~MasterWatch();
  MasterWatch(const MasterWatch&) = delete;
  MasterWatch& operator=(const MasterWatch&) = delete;

 private:
  void run();
  void look();
  void register_again();
  void look_for_clocks();

  std::vector<std::string> services_;
  bool publishes_clock_;
  Notices& notices_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace pliant
