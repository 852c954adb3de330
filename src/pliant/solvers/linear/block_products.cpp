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

}  // namespace pliant
