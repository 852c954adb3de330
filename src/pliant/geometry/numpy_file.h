#pragma once

#include <string>
#include <vector>

namespace pliant {

/// Writes an array of float64, rows first, as a .npy file (NumPy's format 1.0), which numpy.load()
/// reads. `values` holds as many numbers as `shape` says. Throws InputError when it cannot be
/// written.
void write_npy(const std::string& path, const std::vector<std::size_t>& shape,
               const std::vector<double>& values);

}  // namespace pliant
