#pragma once

#include <optional>
#include <vector>

namespace pliant {

struct Body;

/// What a scene says of two of its bodies alone: whether contact between bodies acts there, and
/// with what instead of the numbers for all.
class BodyPairs {
 public:
  struct Numbers {
    std::optional<double> friction, thickness;  ///< Coulomb coefficient; [m]
  };

  /// These touch, with numbers of their own.
  void name(const Body& a, const Body& b, const Numbers& numbers);
  /// These pass through each other, as their scene says.
  void leave_out(const Body& a, const Body& b);
  /// None touch but those that are named.
  void touch_only_named() { only_named_ = true; }

  /// Whether one of the first two was said of them.
  bool are_known(const Body& a, const Body& b) const { return find(a, b) != nullptr; }
  bool may_touch(const Body& a, const Body& b) const;
  bool is_left_out(const Body& a, const Body& b) const;
  /// Of a pair that is not named: none.
  Numbers numbers(const Body& a, const Body& b) const;

 private:
  struct Pair {
    const Body *a, *b;
    bool touches;
    Numbers numbers;
  };
  const Pair* find(const Body& a, const Body& b) const;

  std::vector<Pair> pairs_;
  bool only_named_ = false;
};

}  // namespace pliant
