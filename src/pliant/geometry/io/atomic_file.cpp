#include "pliant/geometry/io/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "pliant/math/error.h"

namespace pliant {

AtomicFile::AtomicFile(std::string target) : target_(std::move(target)) {
  // Beside the target, since a rename is atomic only within one file system.
  static std::atomic<unsigned> serial{0};
  path_ = fmt::format("{}.{}.{}.tmp", target_, getpid(), serial++);
  unlink(path_.c_str());  // of a process that had this number and crashed
  descriptor_ = open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail();
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!published_) unlink(path_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
    if (count >= 0) {
      done += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      fail();
    }
  }
}

void AtomicFile::publish() {
  if (fsync(descriptor_) != 0) fail();
  if (rename(path_.c_str(), target_.c_str()) != 0) fail();
  published_ = true;
}

int AtomicFile::publish_open() {
  publish();
  return std::exchange(descriptor_, -1);
}

void AtomicFile::fail() const {
  throw InputError(fmt::format("cannot write '{}': {}", target_, std::strerror(errno)));
}

void write_file_atomically(const std::string& path, const std::string& bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.publish();
}

}  // namespace pliant
