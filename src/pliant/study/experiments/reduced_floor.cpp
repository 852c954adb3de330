#include <fmt/format.h>

#include <algorithm>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/experiments/reduced_study.h"

namespace pliant {
namespace {

/// Least time of one call, of batches that take about 10 ms each.
template <class Call>
double seconds_of(const Call& call) {
  int count = 1;
  double best = 1e300;
  for (int batch = 0; batch < 25; ++batch) {
    const double start = working_seconds();
    for (int k = 0; k < count; ++k) call();
    const double seconds = working_seconds() - start;
    if (seconds < 0.01) {
      count *= 2;
      continue;
    }
    best = std::min(best, seconds / count);
  }
  return best;
}

/// Some potential of that rank: the time does not depend on its numbers.
QuarticPotential some_potential(int rank) {
  std::vector<double> coefficients(
      static_cast<std::size_t>(QuarticPotential::coefficient_count(rank)));
  for (std::size_t c = 0; c < coefficients.size(); ++c) {
    coefficients[c] = 1e-3 * static_cast<double>(c % 17);
  }
  return QuarticPotential(Eigen::VectorXd::Ones(rank), coefficients, "some potential");
}

/// Multiplications and additions a second of the kernel on rows that stay in the first cache: what
/// this machine can do of this kind of work.
double kernel_rate() {
  constexpr int kRows = 16, kRowLanes = 16;  // 16 kB
  LaneVector rows(kRows * kRowLanes, Lanes{} + 1.0), s(kRowLanes, Lanes{} + 1e-9),
      sum(kRowLanes, Lanes{});
  double weights[kRows], dots[kRows];
  std::fill(std::begin(weights), std::end(weights), 1e-9);
  const double seconds = seconds_of([&] {
    contract({rows.data(), kRows, kRowLanes}, weights, s.data(), sum.data(), dots);
  });
  return 4.0 * kRows * kRowLanes * kLanes / seconds;
}

/// Bytes a second at which `bytes` are summed again and again.
double read_rate(std::int64_t bytes) {
  const auto count = static_cast<std::size_t>(bytes) / sizeof(Lanes);
  LaneVector data(count, Lanes{} + 1.0);
  volatile double keep = 0.0;
  const double seconds = seconds_of([&] { keep = sum_lanes(data.data(), count); });
  (void)keep;
  return static_cast<double>(bytes) / seconds;
}

}  // namespace

bool study_reduced_floor(const ReducedStudyOptions& options, const StudyProgress& progress) {
  std::string rows =
      "rank,coefficients,kb,force_us,tangent_us,flops,gflops,limit_gflops,gb_s,limit_gb_s,"
      "share_of_limit\n";
  const double rate = kernel_rate();
  double done = 0.0;
  for (const int rank : {15, 30, 60}) {
    if (!progress(done++, 3.0, fmt::format("rank {}", rank))) return false;
    const QuarticPotential potential = some_potential(rank);
    QuarticPotential::Workspace space;
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(rank, 1e-3);
    Eigen::VectorXd r;
    Eigen::MatrixXd k;
    const double force = seconds_of([&] { potential.evaluate(q, r, space); });
    const double tangent = seconds_of([&] { potential.evaluate(q, r, k, space); });
    const auto coefficients = static_cast<double>(QuarticPotential::coefficient_count(rank));
    const double flops = 4.0 * coefficients, bytes = 8.0 * coefficients;
    const double bandwidth = read_rate(potential.bytes());
    const double floor = std::max(flops / rate, bytes / bandwidth);
    rows += fmt::format("{},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.3g}\n",
                        rank, coefficients, 1e-3 * static_cast<double>(potential.bytes()),
                        1e6 * force, 1e6 * tangent, flops, 1e-9 * flops / force, 1e-9 * rate,
                        1e-9 * bytes / force, 1e-9 * bandwidth, floor / force);
  }
  write_file_atomically(options.folder + "/floor.csv", rows);
  return true;
}

}  // namespace pliant
