#include <rospack/rospack.h>

#include <chrono>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace {

/// ROS's own index of packages, which crawls workspaces of any depth and knows which of two
/// packages of one name hides the other. All that is asked within a second shares a crawl, such as
/// the meshes of a robot.
class PackageIndex {
 public:
  PackageIndex() { index_.setQuiet(true); }

  /// The folder of a package; "" without.
  std::string find(const std::string& package) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool is_new = crawl(kShared);
    std::string folder;
    if (index_.find(package, folder)) return folder;
    if (is_new) return "";
    crawl(Clock::duration::zero());
    return index_.find(package, folder) ? folder : "";
  }

  std::vector<std::string> names() {
    const std::lock_guard<std::mutex> lock(mutex_);
    crawl(kShared);
    std::set<std::pair<std::string, std::string>> found;
    index_.list(found);
    std::vector<std::string> names;
    for (const auto& [name, folder] : found) names.push_back(name);
    return names;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::duration kShared = std::chrono::seconds(1);

  /// Crawls unless the last time is not longer ago than `age`; whether it did.
  bool crawl(Clock::duration age) {
    std::vector<std::string> path;
    index_.getSearchPathFromEnv(path);
    const Clock::time_point now = Clock::now();
    if (path == path_ && now - crawled_at_ < age) return false;
    index_.crawl(path, true);
    path_ = path;
    crawled_at_ = now;
    return true;
  }

  std::mutex mutex_;  // rospack writes a cache
  rospack::Rospack index_;
  std::vector<std::string> path_;
  Clock::time_point crawled_at_;
};

PackageIndex& package_index() {
  static PackageIndex index;
  return index;
}

}  // namespace

extern "C" void pliant_ros_package(const std::string& package, std::string& folder) {
  folder = package_index().find(package);
}

extern "C" void pliant_ros_packages(std::vector<std::string>& names) {
  names = package_index().names();
}
