#ifndef PLIANT_GEOMETRY_ATOMIC_FILE_H_
#define PLIANT_GEOMETRY_ATOMIC_FILE_H_

#include <string>
#include <string_view>

namespace pliant {

// A file that appears at `target`, complete, when it is published: readers see the old file or the
// new one, never a part, also after a crash. Without that nothing stays of it. A link at `target`
// is replaced, not followed. All throw InputError, saying why, when it cannot be written.
class AtomicFile {
 public:
  explicit AtomicFile(std::string target);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  void write(std::string_view bytes);
  // Once, when all is written.
  void publish();
  // The same; returns the file's descriptor, to go on writing, which the caller closes.
  int publish_open();

 private:
  [[noreturn]] void fail() const;

  std::string target_;
  std::string path_;
  int descriptor_ = -1;
  bool published_ = false;
};

// Replaces the file at `path` by `bytes`: readers see the old file or the new one, never a part,
// also after a crash. Throws InputError, saying why, when it cannot be written.
void write_file_atomically(const std::string& path, const std::string& bytes);

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_ATOMIC_FILE_H_
