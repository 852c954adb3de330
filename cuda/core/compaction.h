#pragma once

#include <cstddef>

#include "cuda/core/prefix_sums.h"

/// Lists of what is flagged, in ascending order, in the memory of an executor.
namespace pliant {

/// Memory for `size` numbers at least, with room for more; what it held is lost where it grows.
template <class Array>
void grow(Array& array, std::size_t size) {
  if (array.size() < size) array.resize(array.size() == 0 ? size : size + size / 4);
}

namespace compaction_kernels {

/// Flags that a thread takes.
constexpr int kRun = 64;

struct CountFlags {
  const unsigned char* flags;
  int size;
  int* counts;
  PLIANT_HOST_DEVICE void operator()(int run) const {
    int count = 0;
    for (int i = run * kRun; i < size && i < (run + 1) * kRun; ++i) count += flags[i];
    counts[run] = count;
  }
};

struct ListFlags {
  const unsigned char* flags;
  int size;
  const int* begins;
  int* list;
  PLIANT_HOST_DEVICE void operator()(int run) const {
    int next = begins[run];
    if (begins[run + 1] == next) return;
    for (int i = run * kRun; i < size && i < (run + 1) * kRun; ++i) {
      if (flags[i] != 0) list[next++] = i;
    }
  }
};

struct CopyNumber {
  const int* from;
  int* to;
  PLIANT_HOST_DEVICE void operator()(int) const { *to = *from; }
};

}  // namespace compaction_kernels

/// Sums before each of some counts, and their sum for the host.
template <class Executor>
class CountedRows {
 public:
  template <class T>
  using Array = typename Executor::template Array<T>;

  /// Memory for the counts of `rows` and one after them, which a kernel has to set, and for zeros
  /// up to size().
  int* counts(int rows) {
    rows_ = rows;
    size_ = whole_prefix_runs(rows + 1);
    grow(counts_, static_cast<std::size_t>(size_));
    grow(sums_, static_cast<std::size_t>(size_ / kPrefixRun));
    return counts_.data();
  }
  int size() const { return size_; }
  /// Counts become what those before each add up to.
  const int* sum(Executor& executor) {
    sum_before(executor, counts_.data(), size_, sums_.data(), counts_.data(), -1);
    return counts_.data();
  }
  /// The sum before `row`, or of all.
  int before(Executor& executor, int row) {
    if (total_.size() == 0) total_.resize(1);
    executor.launch(1, compaction_kernels::CopyNumber{counts_.data() + row, total_.data()});
    int total = 0;
    executor.download(&total, total_, 1);
    return total;
  }
  int total(Executor& executor) { return before(executor, rows_); }

 private:
  int rows_ = 0, size_ = 0;
  Array<int> counts_, sums_, total_;
};

/// What of [0, size) is flagged.
template <class Executor>
class Compaction {
 public:
  template <class T>
  using Array = typename Executor::template Array<T>;

  /// Memory for the flags, 0 or 1, all of which a kernel has to set.
  unsigned char* flags(int size) {
    size_ = size;
    grow(flags_, static_cast<std::size_t>(size));
    return flags_.data();
  }
  /// Lists what is flagged; returns how many that are.
  int run(Executor& executor) {
    using namespace compaction_kernels;
    if (size_ == 0) return 0;
    const int runs = (size_ + kRun - 1) / kRun;
    int* counts = rows_.counts(runs);
    executor.launch(rows_.size(), CountFlags{flags_.data(), size_, counts});
    const int* begins = rows_.sum(executor);
    const int total = rows_.total(executor);
    grow(list_, static_cast<std::size_t>(total));
    if (total > 0) executor.launch(runs, ListFlags{flags_.data(), size_, begins, list_.data()});
    return total;
  }
  const int* list() const { return list_.data(); }

 private:
  int size_ = 0;
  Array<unsigned char> flags_;
  Array<int> list_;
  CountedRows<Executor> rows_;
};

}  // namespace pliant
