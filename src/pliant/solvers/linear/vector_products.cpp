#include "pliant/solvers/linear/vector_products.h"

#include <cstring>

#include "pliant/math/widest.h"

namespace pliant {

PLIANT_WIDEST double dot_product(std::ptrdiff_t count, const double* a, const double* b) {
  constexpr int kSums = 4;
  using Sums = double __attribute__((vector_size(kSums * sizeof(double))));
  Sums sums = {0.0, 0.0, 0.0, 0.0};
  std::ptrdiff_t i = 0;
  for (; i + kSums <= count; i += kSums) {
    Sums left, right;
    std::memcpy(&left, a + i, sizeof left);
    std::memcpy(&right, b + i, sizeof right);
    sums += left * right;
  }
  double even = sums[0] + sums[2], odd = sums[1] + sums[3];
  if (i + 2 <= count) {
    even += a[i] * b[i];
    odd += a[i + 1] * b[i + 1];
    i += 2;
  }
  double sum = even + odd;
  for (; i < count; ++i) sum += a[i] * b[i];
  return sum;
}

PLIANT_WIDEST void add_product(std::ptrdiff_t count, double scale, const double* b, double* a) {
  for (std::ptrdiff_t i = 0; i < count; ++i) a[i] += scale * b[i];
}

}  // namespace pliant
