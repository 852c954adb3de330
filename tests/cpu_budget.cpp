// Part of every test program: a test that takes longer than it should fails. The lesser of the
// processor's time and the clock's counts: other programs make the one longer, many threads that
// wait for work the other.
#include <errno.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace {

double seconds_of(int who) {
  rusage used{};
  getrusage(who, &used);
  const auto seconds = [](const timeval& time) { return time.tv_sec + 1e-6 * time.tv_usec; };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// Of all threads, and of programs that were run and waited for [s].
double cpu_seconds() { return seconds_of(RUSAGE_SELF) + seconds_of(RUSAGE_CHILDREN); }
double clock_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What tests/slow_suites.txt says that a whole suite of this program takes, or 0 [s].
double seconds_of_suite(const std::string& suite) {
  const std::string program = program_invocation_short_name;  // unit_tests holds "unit"
  const std::string full_name = program.substr(0, program.rfind("_tests")) + "." + suite;
  std::ifstream file(PLIANT_SOURCE_DIR "/tests/slow_suites.txt");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    double seconds = 0.0;
    if (words >> name >> seconds && name == full_name) return seconds;
  }
  return 0.0;
}

/// Three times what tests take on a common machine, so that a slow one does not fail them.
class CpuBudget : public testing::EmptyTestEventListener {
 public:
  explicit CpuBudget(double seconds) : seconds_(seconds) {}

  void OnTestStart(const testing::TestInfo&) override {
    cpu_start_ = cpu_seconds();
    clock_start_ = clock_seconds();
  }
  void OnTestEnd(const testing::TestInfo& test) override {
    const double taken = std::min(cpu_seconds() - cpu_start_, clock_seconds() - clock_start_);
    if (taken <= seconds_ || taken <= 3.0 * seconds_of_suite(test.test_suite_name())) return;
    ADD_FAILURE() << "it took " << std::to_string(taken) << " s of processor time, and tests have "
                  << std::to_string(seconds_)
                  << " s: shorten it. Or say in tests/slow_suites.txt what its suite takes: a test "
                     "has three times that. PLIANT_TEST_CPU_SECONDS sets another limit";
  }

 private:
  double seconds_, cpu_start_ = 0.0, clock_start_ = 0.0;
};

[[maybe_unused]] const bool listens = [] {
  const char* asked = std::getenv("PLIANT_TEST_CPU_SECONDS");
  const double seconds = asked != nullptr ? std::atof(asked) : PLIANT_TEST_CPU_SECONDS;
  testing::UnitTest::GetInstance()->listeners().Append(new CpuBudget(seconds));
  return true;
}();

}  // namespace
