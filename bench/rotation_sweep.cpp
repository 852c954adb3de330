// nearest_rotation against a singular value decomposition in double, for any number of random and
// adversarial matrices over 20 decades of scale: `rotation_sweep [COUNT]`, ten million by default.
// Exit code 1 where one result is not finite, not a rotation or not the best one.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <type_traits>

#include "pliant/math/rotation.h"
#include "support/rotation_cases.h"

namespace pliant {
namespace {

// Round-off in F and in R costs a few ε; a rotation of the wrong branch costs the gap, which may be
// small, so that this bound is what "right" can mean for nearly free rotations too.
constexpr double kLargestDeficit = 32.0;
constexpr double kLargestLength = 4.0;
// Where the gap is this large, the angle itself is compared.
constexpr double kConditioned = 0.3;

class Tally {
 public:
  Tally(const char* name, double epsilon) : name_(name), epsilon_(epsilon) {}

  template <typename T>
  void add(const ReferenceRotation& reference, const Quaternion<T>& q) {
    const RotationError error = rotation_error(reference, q);
    ++count_;
    if (!error.finite) {
      ++not_finite_;
      return;
    }
    if (error.length > kLargestLength) ++not_rotations_;
    if (error.deficit > kLargestDeficit) ++not_best_;
    deficit_ = std::max(deficit_, error.deficit);
    angle_ = std::max(angle_, error.angle);
    if (reference.gap < kConditioned) return;
    ++conditioned_;
    conditioned_angle_ = std::max(conditioned_angle_, error.angle / reference.gap * epsilon_);
  }

  bool report() const {
    std::printf(
        "%-12s %ld matrices: %ld not finite, %ld not rotations, %ld not the best; worst loss of "
        "tr(RᵀF) %.1f ε|F|, angle %.1f ε/gap; of %ld with gap > %.1f, angle %.2g rad\n",
        name_, count_, not_finite_, not_rotations_, not_best_, deficit_, angle_, conditioned_,
        kConditioned, conditioned_angle_);
    return not_finite_ + not_rotations_ + not_best_ == 0;
  }

 private:
  const char* name_;
  double epsilon_;
  long count_ = 0, not_finite_ = 0, not_rotations_ = 0, not_best_ = 0, conditioned_ = 0;
  double deficit_ = 0.0, angle_ = 0.0, conditioned_angle_ = 0.0;
};

template <typename T>
void add(const RotationCase& c, Tally& warm, Tally& cold) {
  const Matrix3<T> f = plain_matrix<T>(c.f);
  const ReferenceRotation reference = reference_rotation(wide(f));
  warm.add(reference, nearest_rotation(f, plain_quaternion<T>(c.warm_start)));
  cold.add(reference, nearest_rotation(f));
}

bool sweep(long count) {
  Tally float_warm("float, warm", 0x1p-23), float_cold("float, cold", 0x1p-23);
  Tally double_warm("double, warm", 0x1p-52), double_cold("double, cold", 0x1p-52);
  Random random(1);
  for (long i = 0; i < count; ++i) {
    const RotationCase c = rotation_case(random, static_cast<int>(i % kRotationKinds));
    add<float>(c, float_warm, float_cold);
    add<double>(c, double_warm, double_cold);
  }
  bool right = true;
  for (const Tally* tally : {&float_warm, &float_cold, &double_warm, &double_cold}) {
    right = tally->report() && right;
  }
  return right;
}

}  // namespace
}  // namespace pliant

int main(int argc, char** argv) {
  const long count = argc > 1 ? std::atol(argv[1]) : 10'000'000;
  if (count < 1) {
    std::fprintf(stderr, "usage: %s [COUNT], COUNT >= 1\n", argv[0]);
    return 2;
  }
  return pliant::sweep(count) ? 0 : 1;
}
