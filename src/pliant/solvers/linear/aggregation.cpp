#include "pliant/solvers/linear/aggregation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {

constexpr int kGrain = 1024;
// Of the row's strongest tie.
constexpr double kStrong = 0.08;
// Where off-diagonal entries sum up to no more than that share of the diagonal, a few sweeps solve:
// eigenvalues of D⁻¹A are that close to 1 there.
constexpr double kDominated = 0.4;
// Of the Jacobi iteration: 4/3 over the largest eigenvalue, which is 2 at the most.
constexpr double kSmoothing = 2.0 / 3.0;

/// What ties of each row are strong: A_ij of no more than this; −∞ where the diagonal rules.
std::vector<double> strong_below(const SparseRows& a) {
  std::vector<double> bounds(static_cast<std::size_t>(a.rows()));
  parallel_for(0, static_cast<int>(a.rows()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      double sum = 0.0, strongest = 0.0, diagonal = 0.0;
      for (SparseRows::InnerIterator entry(a, i); entry; ++entry) {
        if (entry.col() == i) {
          diagonal = entry.value();
          continue;
        }
        sum += std::abs(entry.value());
        strongest = std::min(strongest, entry.value());
      }
      const bool is_tied = strongest < 0.0 && sum > kDominated * diagonal;
      bounds[static_cast<std::size_t>(i)] =
          is_tied ? kStrong * strongest : -std::numeric_limits<double>::infinity();
    }
  });
  return bounds;
}

/// Calls use(j, A_ij) for the strong ties of row i.
template <class Use>
void for_each_strong(const SparseRows& a, const std::vector<double>& bounds, int i,
                     const Use& use) {
  const double bound = bounds[static_cast<std::size_t>(i)];
  if (!std::isfinite(bound)) return;
  for (SparseRows::InnerIterator entry(a, i); entry; ++entry) {
    const auto j = static_cast<int>(entry.col());
    if (j == i || entry.value() > bound) continue;
    if (std::isfinite(bounds[static_cast<std::size_t>(j)])) use(j, entry.value());
  }
}

/// Rows all of whose strong neighbours are free yet take them.
void begin_aggregates(const SparseRows& a, const std::vector<double>& bounds,
                      Aggregation& aggregation) {
  std::vector<int>& of = aggregation.of;
  for (int i = 0; i < a.rows(); ++i) {
    if (of[static_cast<std::size_t>(i)] != Aggregation::kNone) continue;
    int neighbors = 0;
    bool all_are_free = true;
    for_each_strong(a, bounds, i, [&](int j, double) {
      ++neighbors;
      all_are_free = all_are_free && of[static_cast<std::size_t>(j)] == Aggregation::kNone;
    });
    if (neighbors == 0 || !all_are_free) continue;
    const int number = aggregation.count++;
    of[static_cast<std::size_t>(i)] = number;
    for_each_strong(a, bounds, i, [&](int j, double) { of[static_cast<std::size_t>(j)] = number; });
  }
}

/// The others join the aggregate of their strongest neighbour that had one by then.
void join_aggregates(const SparseRows& a, const std::vector<double>& bounds,
                     Aggregation& aggregation) {
  const std::vector<int> begun = aggregation.of;
  parallel_for(0, static_cast<int>(a.rows()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (begun[static_cast<std::size_t>(i)] != Aggregation::kNone) continue;
      double strongest = 0.0;
      for_each_strong(a, bounds, i, [&](int j, double value) {
        const int number = begun[static_cast<std::size_t>(j)];
        if (number == Aggregation::kNone || value >= strongest) return;
        strongest = value;
        aggregation.of[static_cast<std::size_t>(i)] = number;
      });
    }
  });
}

/// Rows that one thread makes, one after the other.
struct RowPart {
  std::vector<int> sizes, columns;
  std::vector<double> values;
};

/// A matrix of rows that make(begin, end, part) appends to their part.
template <class Make>
SparseRows from_rows(int rows, int columns, int grain, const Make& make) {
  const int parts = (rows + grain - 1) / grain;
  std::vector<RowPart> made(static_cast<std::size_t>(parts));
  parallel_for(0, parts, 1, [&](int first, int last) {
    for (int p = first; p < last; ++p) {
      make(p * grain, std::min(rows, (p + 1) * grain), made[static_cast<std::size_t>(p)]);
    }
  });
  SparseRows result(rows, columns);
  int row = 0, total = 0;
  int* begins = result.outerIndexPtr();
  std::vector<int> firsts;
  for (const RowPart& part : made) {
    firsts.push_back(total);
    for (int size : part.sizes) {
      begins[row++] = total;
      total += size;
    }
  }
  begins[row] = total;
  result.resizeNonZeros(total);
  parallel_for(0, parts, 1, [&](int first, int last) {
    for (int p = first; p < last; ++p) {
      const auto at = static_cast<std::size_t>(p);
      std::copy(made[at].columns.begin(), made[at].columns.end(),
                result.innerIndexPtr() + firsts[at]);
      std::copy(made[at].values.begin(), made[at].values.end(), result.valuePtr() + firsts[at]);
    }
  });
  return result;
}

/// Adds up one row after the other.
class RowSum {
 public:
  explicit RowSum(int columns) : values_(static_cast<std::size_t>(columns), kUnused) {}

  void add(int column, double value) {
    double& sum = values_[static_cast<std::size_t>(column)];
    if (std::isnan(sum)) {
      used_.push_back(column);
      sum = 0.0;
    }
    sum += value;
  }
  /// Appends the row, and begins another one.
  void take(RowPart& part) {
    std::sort(used_.begin(), used_.end());
    part.sizes.push_back(static_cast<int>(used_.size()));
    for (int column : used_) {
      double& sum = values_[static_cast<std::size_t>(column)];
      part.columns.push_back(column);
      part.values.push_back(sum);
      sum = kUnused;
    }
    used_.clear();
  }

 private:
  static constexpr double kUnused = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values_;
  std::vector<int> used_;
};

}  // namespace

Aggregation aggregate(const SparseRows& a) {
  Aggregation aggregation;
  aggregation.of.assign(static_cast<std::size_t>(a.rows()), Aggregation::kNone);
  const std::vector<double> bounds = strong_below(a);
  begin_aggregates(a, bounds, aggregation);
  join_aggregates(a, bounds, aggregation);
  return aggregation;
}

SparseRows smoothed_prolongation(const SparseRows& a, const Aggregation& aggregation) {
  const std::vector<double> bounds = strong_below(a);
  const std::vector<int>& of = aggregation.of;
  const auto make = [&](int begin, int end, RowPart& part) {
    RowSum row(aggregation.count);
    for (int i = begin; i < end; ++i) {
      double sum = 0.0;
      for_each_strong(a, bounds, i, [&](int, double value) { sum += value; });
      if (of[static_cast<std::size_t>(i)] != Aggregation::kNone) {
        row.add(of[static_cast<std::size_t>(i)], 1.0 - kSmoothing);
        for_each_strong(a, bounds, i, [&](int j, double value) {
          row.add(of[static_cast<std::size_t>(j)], kSmoothing * value / sum);
        });
      }
      row.take(part);
    }
  };
  return from_rows(static_cast<int>(a.rows()), aggregation.count, kGrain, make);
}

SparseRows product(const SparseRows& a, const SparseRows& b) {
  constexpr int kRows = 2048;  // of a part: each needs a number a column
  const auto rows = static_cast<int>(a.rows()), columns = static_cast<int>(b.cols());
  return from_rows(rows, columns, kRows, [&](int begin, int end, RowPart& part) {
    RowSum row(columns);
    for (int i = begin; i < end; ++i) {
      for (SparseRows::InnerIterator entry(a, i); entry; ++entry) {
        for (SparseRows::InnerIterator other(b, entry.col()); other; ++other) {
          row.add(static_cast<int>(other.col()), entry.value() * other.value());
        }
      }
      row.take(part);
    }
  });
}

}  // namespace pliant
