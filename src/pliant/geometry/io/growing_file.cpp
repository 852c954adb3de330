#include "pliant/geometry/io/growing_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/error.h"

namespace pliant {

GrowingFile::GrowingFile(std::string path, int flags)
    : path_(std::move(path)),
      // A pipe without a reader would be waited for.
      descriptor_(
          ::open(path_.c_str(), flags | O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail();
}

GrowingFile::GrowingFile(std::string path, int descriptor, std::nullptr_t)
    : path_(std::move(path)), descriptor_(descriptor) {}

GrowingFile GrowingFile::create(std::string path) { return {std::move(path), O_CREAT | O_EXCL}; }

GrowingFile GrowingFile::replace(std::string path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  return {std::move(path), file.publish_open(), nullptr};
}

GrowingFile GrowingFile::open(std::string path) {
  GrowingFile file(std::move(path), 0);
  struct stat status = {};
  if (fstat(file.descriptor_, &status) != 0) file.fail();
  if (!S_ISREG(status.st_mode) || status.st_nlink != 1) {
    throw InputError(
        fmt::format("cannot write '{}': it is no file, or has other names too", file.path_));
  }
  return file;
}

GrowingFile::GrowingFile(GrowingFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

GrowingFile::~GrowingFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::size_t GrowingFile::size() const {
  struct stat status = {};
  if (fstat(descriptor_, &status) != 0) fail();
  return static_cast<std::size_t>(status.st_size);
}

void GrowingFile::cut(std::size_t bytes) const {
  if (ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) fail();
}

void GrowingFile::append(std::string_view bytes) const {
  const std::size_t before = size();
  try {
    write_at(before, bytes);
  } catch (const InputError&) {
    // Whole rows only, also on a full disk. Why they do not fit is what is told.
    [[maybe_unused]] const int ignored = ftruncate(descriptor_, static_cast<off_t>(before));
    throw;
  }
}

void GrowingFile::write_at(std::size_t place, std::string_view bytes) const {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t now = pwrite(descriptor_, bytes.data() + done, bytes.size() - done,
                               static_cast<off_t>(place + done));
    if (now < 0 && errno != EINTR) fail();
    if (now > 0) done += static_cast<std::size_t>(now);
  }
}

std::size_t GrowingFile::read_at(std::size_t place, std::string& bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t now = pread(descriptor_, bytes.data() + done, bytes.size() - done,
                              static_cast<off_t>(place + done));
    if (now < 0 && errno != EINTR) {
      throw InputError(fmt::format("cannot read '{}': {}", path_, std::strerror(errno)));
    }
    if (now == 0) break;
    if (now > 0) done += static_cast<std::size_t>(now);
  }
  return done;
}

void GrowingFile::sync() const {
  if (fdatasync(descriptor_) != 0) fail();
}

void GrowingFile::fail() const {
  throw InputError(fmt::format("cannot write '{}': {}", path_, std::strerror(errno)));
}

}  // namespace pliant
