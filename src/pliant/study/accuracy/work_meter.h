#pragma once

#include <functional>
#include <string>

namespace pliant {

/// Hears how far a study is: work done and in all, in iterations of a solver, and what runs now.
/// Returns false to stop the study.
using StudyListener = std::function<bool(double done, double total, const std::string& what)>;

/// Counts the work of a study and tells a listener.
class WorkMeter {
 public:
  explicit WorkMeter(StudyListener listener) : listener_(std::move(listener)) {}

  void expect(double work) { total_ += work; }
  /// False when the study shall stop.
  bool add(double work, const std::string& what) {
    done_ += work;
    return !listener_ || listener_(done_, total_, what);
  }

 private:
  StudyListener listener_;
  double done_ = 0.0;
  double total_ = 0.0;
};

/// How a part of a study ended.
struct StudyStatus {
  enum class End { kDone, kInterrupted, kNotFinite };
  End end = End::kDone;
  std::string message;  ///< of what was not finite

  bool is_done() const { return end == End::kDone; }
  static StudyStatus interrupted() { return {End::kInterrupted, {}}; }
  static StudyStatus not_finite(std::string message) {
    return {End::kNotFinite, std::move(message)};
  }
};

}  // namespace pliant
