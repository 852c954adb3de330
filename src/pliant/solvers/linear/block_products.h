#pragma once

#include <Eigen/Core>

namespace pliant {

/// y_i = Σ A_e v_(columns[e]) over the entries e in [begins[i], begins[i + 1]) of each row i in
/// [first, last), by vector registers. `blocks` holds 3x3 blocks, one after the other and by
/// columns, and one number behind the last of them that is read and not used; `v` and `y` hold 3
/// numbers a column. The same bits for any width of registers.
void multiply_block_rows(int first, int last, const int* begins, const int* columns,
                         const double* blocks, const double* v, double* y);

/// y_i += Σ numbers[e] v_(columns[e]) likewise, for blocks that are numbers times the identity;
/// `columns` of a row rise, and `v` has `count` of them.
void add_isotropic_rows(int first, int last, const int* begins, const int* columns,
                        const double* numbers, const double* v, int count, double* y);

}  // namespace pliant
