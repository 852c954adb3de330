#include "pliant/core/system/body_pairs.h"

namespace pliant {

void BodyPairs::name(const Body& a, const Body& b, const Numbers& numbers) {
  pairs_.push_back({&a, &b, true, numbers});
}

void BodyPairs::leave_out(const Body& a, const Body& b) { pairs_.push_back({&a, &b, false, {}}); }

const BodyPairs::Pair* BodyPairs::find(const Body& a, const Body& b) const {
  for (const Pair& pair : pairs_) {
    if ((pair.a == &a && pair.b == &b) || (pair.a == &b && pair.b == &a)) return &pair;
  }
  return nullptr;
}

bool BodyPairs::may_touch(const Body& a, const Body& b) const {
  const Pair* pair = find(a, b);
  return pair == nullptr ? !only_named_ : pair->touches;
}

bool BodyPairs::is_left_out(const Body& a, const Body& b) const {
  const Pair* pair = find(a, b);
  return pair != nullptr && !pair->touches;
}

BodyPairs::Numbers BodyPairs::numbers(const Body& a, const Body& b) const {
  const Pair* pair = find(a, b);
  return pair == nullptr ? Numbers() : pair->numbers;
}

}  // namespace pliant
