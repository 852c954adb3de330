#include "pliant/geometry/io/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "pliant/math/error.h"

namespace pliant {
namespace {

/// " (process N)" of who holds a lock on the file, or nothing where the system does not say.
std::string holder(int descriptor) {
  struct stat status;
  if (fstat(descriptor, &status) != 0) return "";
  const std::string inode = fmt::format(":{}", status.st_ino);
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    // "1: FLOCK  ADVISORY  WRITE 4711 08:01:123456 0 EOF"
    std::istringstream words(line);
    std::string number, kind, mode, access, process, file;
    words >> number >> kind >> mode >> access >> process >> file;
    const bool is_it = kind == "FLOCK" && file.size() > inode.size() &&
                       file.compare(file.size() - inode.size(), inode.size(), inode) == 0;
    if (is_it) return fmt::format(" (process {})", process);
  }
  return "";
}

}  // namespace

FolderLock::FolderLock(const std::string& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) {
    throw InputError(fmt::format("{}: cannot be used: {}", folder, std::strerror(errno)));
  }
  descriptor_ = std::shared_ptr<const int>(new int(descriptor), [](const int* held) {
    close(*held);
    delete held;
  });
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw InputError(
        fmt::format("{}: another one is at work there{}; wait for it, or choose another --out",
                    folder, holder(descriptor)));
  }
}

}  // namespace pliant
