#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// The lines of a text file whose "*INCLUDE name" lines stand for another file beside it. Comments
/// (from '#' on), spaces at the ends and empty lines are left out. At most kMaxIncludes files are
/// included, none by itself, and none from outside of the folder of the file that names it.
class IncludedLines {
 public:
  static constexpr int kMaxIncludes = 64;

  IncludedLines(std::string path, std::string bytes);

  /// Whether there is another line; what line() gives then. Throws InputError for an include that
  /// cannot be read.
  bool next();
  /// Good until the next call of next().
  std::string_view line() const { return line_; }
  /// The line once more, with the next call of next().
  void hold() { is_held_ = true; }
  /// Throws InputError "mesh '<path>', line 12: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct File {
    std::string path, bytes;
    std::size_t at = 0, number = 0;  // of the line read last
  };
  void include(std::string_view name);

  std::vector<File> files_;  // the last one is being read
  std::string path_;         // of the line read last
  std::size_t number_ = 0;
  std::string line_;
  int includes_ = 0;
  bool is_held_ = false;
};

}  // namespace pliant
