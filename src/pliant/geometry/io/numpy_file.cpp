#include "pliant/geometry/io/numpy_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/error.h"

namespace pliant {

namespace {

constexpr std::size_t kGrowingHeader = 256;  // bytes, whatever the number of items

/// Up to where the data begin: at a multiple of 64 bytes, and `least` at least.
std::string npy_header(const std::vector<std::size_t>& shape, std::size_t least) {
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (";
  for (std::size_t size : shape) header += std::to_string(size) + ", ";
  header += "), }";
  // Magic, version and length take 10 bytes; the data begin at a multiple of 64.
  constexpr std::size_t kBefore = 10, kAlignment = 64;
  while ((kBefore + header.size() + 1) % kAlignment != 0 || kBefore + header.size() + 1 < least) {
    header += ' ';
  }
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() % 256);
  bytes += static_cast<char>(header.size() / 256);
  return bytes + header;
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

GrowingNpy::GrowingNpy(std::string path, std::vector<std::size_t> item_shape, std::size_t kept)
    : path_(std::move(path)), shape_(std::move(item_shape)) {
  for (const std::size_t size : shape_) item_size_ *= size;
  shape_.insert(shape_.begin(), kept);
  const int flags = O_WRONLY | O_NOFOLLOW | O_CLOEXEC | (kept == 0 ? O_CREAT | O_TRUNC : 0);
  descriptor_ = open(path_.c_str(), flags, 0666);
  if (descriptor_ < 0) fail();
  const std::size_t size = kGrowingHeader + kept * item_size_ * sizeof(double);
  struct stat there = {};
  if (fstat(descriptor_, &there) != 0) fail();
  if (kept > 0 && static_cast<std::size_t>(there.st_size) < size) {
    throw InputError(fmt::format("'{}' is shorter than it was left: begin anew", path_));
  }
  publish(kept);
}

GrowingNpy::GrowingNpy(GrowingNpy&& other) noexcept
    : path_(std::move(other.path_)),
      shape_(std::move(other.shape_)),
      item_size_(other.item_size_),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

GrowingNpy::~GrowingNpy() {
  if (descriptor_ >= 0) close(descriptor_);
}

void GrowingNpy::write(std::size_t item, std::size_t offset, const double* numbers,
                       std::size_t count) const {
  write_bytes(numbers, count * sizeof(double),
              kGrowingHeader + (item * item_size_ + offset) * sizeof(double));
}

void GrowingNpy::leave_out(std::size_t item) const {
  const std::vector<double> missing(std::min<std::size_t>(item_size_, 4096),
                                    std::numeric_limits<double>::quiet_NaN());
  for (std::size_t done = 0; done < item_size_; done += missing.size()) {
    write(item, done, missing.data(), std::min(missing.size(), item_size_ - done));
  }
}

void GrowingNpy::publish(std::size_t items) const {
  std::vector<std::size_t> shape = shape_;
  shape.front() = items;
  const std::string header = npy_header(shape, kGrowingHeader);
  if (fdatasync(descriptor_) != 0) fail();
  write_bytes(header.data(), header.size(), 0);
}

void GrowingNpy::write_bytes(const void* bytes, std::size_t count, std::size_t at) const {
  const char* from = static_cast<const char*>(bytes);
  for (std::size_t done = 0; done < count;) {
    const ssize_t now =
        pwrite(descriptor_, from + done, count - done, static_cast<off_t>(at + done));
    if (now < 0 && errno != EINTR) fail();
    if (now > 0) done += static_cast<std::size_t>(now);
  }
}

void GrowingNpy::fail() const {
  throw InputError(fmt::format("cannot write '{}': {}", path_, std::strerror(errno)));
}

}  // namespace pliant
