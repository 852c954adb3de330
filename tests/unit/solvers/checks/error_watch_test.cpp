// What the steps that nobody looked at are taken to have missed.
#include "pliant/solvers/checks/error_watch.h"

#include <gtest/gtest.h>

#include <functional>

#include "support/solvers/system_model.h"

namespace pliant::error_watch_test {
namespace {

constexpr double kMass = 2.0, kDt = 1e-3;

/// Two particles on a spring in space. Each step is exact but for what it is told to miss.
class SteppedBody {
 public:
  SteppedBody() : model_(line(), kMass) {
    model_.add("spring", {{0, 1, 1.0, 500.0}});
    system().external_forces.setZero(3, 2);
    watch_.prepare(system());
  }

  /// A step on a body at rest that ends `miss` below where it should be.
  void step(double miss) {
    Particles& p = model_.particles();
    p.x_start = p.x;
    for (int i = 0; i < 2; ++i) p.x(2, i) -= miss;
    report_ = StepReport();
    report_.step = ++step_;
    report_.dt = kDt;
    report_.time = kDt * static_cast<double>(step_);
    report_.iterations = 1;
    watch_.observe(system(), kDt, "look", report_);
    p.v.setZero();
  }

  const StepReport& report() const { return report_; }
  /// Told error, as a length [m].
  double told() const { return report_.error.value_or(0.0) * kLeastDistance; }

 private:
  // Distances count at least as a hundredth of the root mean square of a body's radius, 0.5 m.
  static constexpr double kLeastDistance = 0.005;

  static Positions line() {
    Positions x = Positions::Zero(3, 2);
    x(0, 1) = 1.0;
    return x;
  }
  ProjectiveSystem& system() { return static_cast<ProjectiveSystem&>(model_.system()); }

  SystemModel model_;
  ErrorWatch watch_;
  StepReport report_;
  std::uint64_t step_ = 0;
};

/// The first step that is looked at after at least `gap` others that are not.
std::uint64_t step_after_gap(std::uint64_t gap) {
  SteppedBody body;
  std::uint64_t last = 0;
  for (int k = 0; k < 2000; ++k) {
    body.step(0.0);
    const std::uint64_t at = body.report().error_step;
    if (at > last + gap) return at;
    last = at;
  }
  return 0;
}

// It was once taken for what all steps since the former look missed: up to 30 times as much.
TEST(ErrorWatch, AnOddStepStandsForItself) {
  const std::uint64_t odd = step_after_gap(8);
  ASSERT_GT(odd, 8u);
  constexpr double kMiss = 1e-4;
  SteppedBody body;
  for (std::uint64_t k = 1; k <= odd; ++k) body.step(k == odd ? kMiss : 0.0);
  EXPECT_EQ(body.report().error_step, odd);
  EXPECT_GE(body.told(), kMiss);
  EXPECT_LE(body.told(), 3.0 * kMiss);
  // The next look finds that nothing else was missed.
  body.step(0.0);
  EXPECT_EQ(body.report().error_step, odd + 1);
  EXPECT_LE(body.told(), 5.0 * kMiss);
}

}  // namespace
}  // namespace pliant::error_watch_test
