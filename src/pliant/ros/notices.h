#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace pliant {

/// What is wrong around a node, and stays so until somebody says that it is over; for /diagnostics.
/// Any thread may use it.
class Notices {
 public:
  /// Replaces what `about` was said to be. Returns whether that is new.
  bool set(const std::string& about, const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::string& known = texts_[about];
    if (known == text) return false;
    known = text;
    return true;
  }
  /// Returns whether there was one.
  bool clear(const std::string& about) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return texts_.erase(about) > 0;
  }
  std::vector<std::string> all() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<std::string> texts;
    for (const auto& [about, text] : texts_) texts.push_back(text);
    return texts;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> texts_;  // by what they are about
};

}  // namespace pliant
