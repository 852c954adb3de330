#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pliant {

/// A file that is written bit by bit, each as soon as it is asked for: a process that is killed
/// loses nothing that was written. With AtomicFile the only place where Pliant opens a file to
/// write. No link is followed, and what has other names too is not touched, so that nothing but
/// this file changes. All throw InputError, saying why, where it cannot be written or read.
class GrowingFile {
 public:
  /// A new one. Refused where anything has that name, a link that leads nowhere too.
  static GrowingFile create(std::string path);
  /// A new one that holds `bytes`, at once in the place of what has that name.
  static GrowingFile replace(std::string path, std::string_view bytes);
  /// The one that is there.
  static GrowingFile open(std::string path);

  GrowingFile(GrowingFile&& other) noexcept;
  GrowingFile& operator=(GrowingFile&&) = delete;
  ~GrowingFile();

  const std::string& path() const { return path_; }
  std::size_t size() const;  ///< bytes
  /// Cuts the file off after so many bytes.
  void cut(std::size_t bytes) const;
  /// Adds all bytes at its end, or none.
  void append(std::string_view bytes) const;
  /// Puts bytes at a place; several threads may.
  void write_at(std::size_t place, std::string_view bytes) const;
  /// Fills `bytes` from a place on; returns how many there are.
  std::size_t read_at(std::size_t place, std::string& bytes) const;
  /// What was written is on the disk then.
  void sync() const;

 private:
  GrowingFile(std::string path, int flags);
  GrowingFile(std::string path, int descriptor, std::nullptr_t);
  [[noreturn]] void fail() const;

  std::string path_;
  int descriptor_ = -1;
};

}  // namespace pliant
