#include "pliant/geometry/io/numpy_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/error.h"

namespace pliant {

namespace {

constexpr std::size_t kGrowingHeader = 256;  // bytes, whatever the number of items
constexpr std::size_t kMagic = 10;           // bytes: what it is, its version, the header's length

/// Up to where the data begin: at a multiple of 64 bytes, and `least` at least.
std::string npy_header(const std::vector<std::size_t>& shape, std::size_t least) {
  // As NumPy itself and scripts/sweep_merge.py write it; a tuple of one number ends with a comma.
  std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}{}), }}",
                                   fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
  // Magic, version and length take 10 bytes; the data begin at a multiple of 64.
  constexpr std::size_t kAlignment = 64;
  while ((kMagic + header.size() + 1) % kAlignment != 0 || kMagic + header.size() + 1 < least) {
    header += ' ';
  }
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() % 256);
  bytes += static_cast<char>(header.size() / 256);
  return bytes + header;
}

/// Throws InputError where what is at `path` was not written by a GrowingNpy.
void check_replaceable(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status there = fs::symlink_status(path, error);
  if (!fs::exists(there)) return;
  const std::string own = npy_header({0}, kGrowingHeader).substr(0, kMagic);
  std::string first(kMagic, '\0');
  if (fs::is_regular_file(there)) {
    std::ifstream(path, std::ios::binary).read(first.data(), kMagic);
  }
  if (first == own) return;
  throw InputError(fmt::format(
      "'{}' is there and was not written by a batch: move it away, or choose another folder",
      path));
}

}  // namespace

void write_npy(const std::string& path, const std::vector<std::size_t>& shape,
               const std::vector<double>& values) {
  std::string bytes = npy_header(shape, 0);
  const std::size_t begin = bytes.size();
  bytes.resize(begin + values.size() * sizeof(double));
  if (!values.empty()) {
    std::memcpy(&bytes[begin], values.data(), values.size() * sizeof(double));
  }
  write_file_atomically(path, bytes);
}

GrowingNpy::GrowingNpy(const std::string& path, std::vector<std::size_t> item_shape,
                       std::size_t kept, bool is_there)
    : shape_(std::move(item_shape)) {
  for (const std::size_t size : shape_) item_size_ *= size;
  shape_.insert(shape_.begin(), kept);
  if (kept == 0 && !is_there) {
    check_replaceable(path);
    file_.emplace(GrowingFile::replace(path, header_of(0)));
    return;
  }
  file_.emplace(GrowingFile::open(path));
  if (file_->size() < kGrowingHeader + kept * item_size_ * sizeof(double)) {
    throw InputError(fmt::format("'{}' is shorter than it was left: begin anew", path));
  }
  publish(kept);
}

void GrowingNpy::write(std::size_t item, std::size_t offset, const double* numbers,
                       std::size_t count) const {
  file_->write_at(kGrowingHeader + (item * item_size_ + offset) * sizeof(double),
                  {reinterpret_cast<const char*>(numbers), count * sizeof(double)});
}

void GrowingNpy::leave_out(std::size_t item) const {
  const std::vector<double> missing(std::min<std::size_t>(item_size_, 4096),
                                    std::numeric_limits<double>::quiet_NaN());
  for (std::size_t done = 0; done < item_size_; done += missing.size()) {
    write(item, done, missing.data(), std::min(missing.size(), item_size_ - done));
  }
}

void GrowingNpy::publish(std::size_t items) const {
  file_->sync();
  file_->write_at(0, header_of(items));
}

std::string GrowingNpy::header_of(std::size_t items) const {
  std::vector<std::size_t> shape = shape_;
  shape.front() = items;
  return npy_header(shape, kGrowingHeader);
}

}  // namespace pliant
