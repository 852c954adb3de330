#pragma once

#include <algorithm>

namespace pliant {

/// Bodies that begin too deep in an obstacle: how deep they still may be. What is parted keeps the
/// speed at which it was, so a body that is put down a little too deep would jump if contact parted
/// it within one step.
class Opening {
 public:
  static constexpr double kSlowest = 0.02;  ///< as after a fall by 20 µm, which nobody sees [m/s]
  static constexpr double kFastest = 1.0;   ///< of what is deep inside [m/s]
  static constexpr double kTime = 0.02;     ///< in which the speed between the two opens all [s]

  /// Speed at which what is `depth` [m] too deep is parted [m/s].
  static double speed(double depth) { return std::clamp(depth / kTime, kSlowest, kFastest); }

  /// Whether the depth of the start is known.
  bool has_begun() const { return left_ >= 0.0; }
  /// From the start, where the deepest point is `depth` too deep [m]. What a step of `dt` [s] opens
  /// at the least speed needs no care.
  void begin(double depth, double dt) { left_ = depth > kSlowest * dt ? depth : 0.0; }
  /// A step begins that may be undone.
  void begin_step() { before_ = left_; }
  /// A step of `dt` [s].
  void advance(double dt) { left_ = std::max(0.0, left_ - speed(left_) * dt); }
  void undo_step() { left_ = before_; }
  void reset() { left_ = before_ = kUnknown; }
  /// How deep a point that is too deep may still be at the end of this step [m].
  double left() const { return std::max(0.0, left_); }

  /// The state, for archives.
  double state() const { return left_; }
  void set_state(double state) { left_ = before_ = state; }

 private:
  static constexpr double kUnknown = -1.0;
  double left_ = kUnknown, before_ = kUnknown;
};

}  // namespace pliant
