#pragma once

#include <cstddef>

/// Sums and products of long vectors by registers as wide as there are. The same bits for any
/// width of them.
namespace pliant {

/// Σ a_i b_i of `count` numbers, in four sums.
double dot_product(std::ptrdiff_t count, const double* a, const double* b);
/// a_i += scale b_i.
void add_product(std::ptrdiff_t count, double scale, const double* b, double* a);

}  // namespace pliant
