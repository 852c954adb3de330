#include "pliant/solvers/linear/block_products.h"

#include <cstring>

#include "pliant/math/widest.h"

namespace pliant {
namespace {
// Three numbers of a column of a block, and one behind them that nothing uses.
using Column = double __attribute__((vector_size(32)));
}  // namespace

PLIANT_WIDEST void multiply_block_rows(int first, int last, const int* begins, const int* columns,
                                       const double* blocks, const double* v, double* y) {
  for (int row = first; row < last; ++row) {
    Column sum = {0.0, 0.0, 0.0, 0.0};
    for (int entry = begins[row]; entry < begins[row + 1]; ++entry) {
      const double* block = blocks + 9 * static_cast<std::ptrdiff_t>(entry);
      const double* x = v + 3 * static_cast<std::ptrdiff_t>(columns[entry]);
      Column a, b, c;
      std::memcpy(&a, block, sizeof a);
      std::memcpy(&b, block + 3, sizeof b);
      std::memcpy(&c, block + 6, sizeof c);
      sum += a * x[0] + (b * x[1] + c * x[2]);
    }
    double* to = y + 3 * static_cast<std::ptrdiff_t>(row);
    for (int c = 0; c < 3; ++c) to[c] = sum[c];
  }
}

PLIANT_WIDEST void add_isotropic_rows(int first, int last, const int* begins, const int* columns,
                                      const double* scalars, const double* v, int count,
                                      double* y) {
  for (int row = first; row < last; ++row) {
    const int begin = begins[row];
    int end = begins[row + 1];
    // Behind the last column there is nothing that a register could read.
    const bool has_last = end > begin && columns[end - 1] == count - 1;
    if (has_last) --end;
    const auto times = [&](int entry) {
      Column x;
      std::memcpy(&x, v + 3 * static_cast<std::ptrdiff_t>(columns[entry]), sizeof x);
      return x * scalars[entry];
    };
    // Two sums, so that none waits for the one before.
    Column even = {0.0, 0.0, 0.0, 0.0}, odd = {0.0, 0.0, 0.0, 0.0};
    int entry = begin;
    for (; entry + 1 < end; entry += 2) {
      even += times(entry);
      odd += times(entry + 1);
    }
    if (entry < end) even += times(entry);
    const Column sum = even + odd;
    double* to = y + 3 * static_cast<std::ptrdiff_t>(row);
    for (int c = 0; c < 3; ++c) to[c] += sum[c];
    if (!has_last) continue;
    const double* x = v + 3 * static_cast<std::ptrdiff_t>(count - 1);
    for (int c = 0; c < 3; ++c) to[c] += scalars[end] * x[c];
  }
}

}  // namespace pliant
