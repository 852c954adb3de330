#include "pliant/geometry/numpy_file.h"

#include <cstring>

#include "pliant/geometry/atomic_file.h"

namespace pliant {

void write_npy(const std::string& path, const std::vector<std::size_t>& shape,
               const std::vector<double>& values) {
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (";
  for (std::size_t size : shape) header += std::to_string(size) + ", ";
  header += "), }";
  // Magic, version and length take 10 bytes; the data begin at a multiple of 64.
  constexpr std::size_t kBefore = 10, kAlignment = 64;
  while ((kBefore + header.size() + 1) % kAlignment != 0) header += ' ';
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() % 256);
  bytes += static_cast<char>(header.size() / 256);
  bytes += header;
  const std::size_t begin = bytes.size();
  bytes.resize(begin + values.size() * sizeof(double));
  if (!values.empty()) {
    std::memcpy(&bytes[begin], values.data(), values.size() * sizeof(double));
  }
  write_file_atomically(path, bytes);
}

}  // namespace pliant
