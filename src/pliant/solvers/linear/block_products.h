#pragma once

#include <Eigen/Core>

namespace pliant {

/// y_i = Σ A_e v_(columns[e]) over the entries e in [begins[i], begins[i + 1]) of each row i in
/// [first, last), by vector registers. `blocks` holds 3x3 blocks, one after the other and by
/// columns, and one number behind the last of them that is read and not used; `v` and `y` hold 3
/// numbers a column. The same bits for any width of registers.
void multiply_block_rows(int first, int last, const int* begins, const int* columns,
                         const double* blocks, const double* v, double* y);

/// y_i += Σ scalars[e] v_(columns[e]) likewise, for blocks that are scalars times the identity. The
/// `columns` of each row are in ascending order, and `v` has `count` columns.
void add_isotropic_rows(int first, int last, const int* begins, const int* columns,
                        const double* scalars, const double* v, int count, double* y);

}  // namespace pliant
