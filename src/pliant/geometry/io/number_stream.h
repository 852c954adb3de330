#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pliant {

/// Reads the numbers of a mesh file, text or little-endian binary, from its bytes. Every error is
/// an InputError "mesh '<path>', line 12: ..." (or "byte 345" where the numbers are binary).
class NumberStream {
 public:
  /// The bytes must outlive the stream.
  NumberStream(std::string path, std::string_view bytes);

  void set_binary(bool binary) { binary_ = binary; }

  /// The rest of the line without spaces at its ends; empty at the end of the file.
  std::string_view line();
  /// Drops what is left of the line.
  void skip_line() { line(); }
  /// Moves behind the next line that is exactly `text`; throws where there is none.
  void skip_past_line(std::string_view text);
  bool at_end();

  /// In text files a '#' hides the rest of its line.
  void set_comments(bool on) { comments_ = on; }

  std::int64_t integer32();  ///< a whole number; 4 bytes where binary
  std::int64_t integer64();  ///< a whole number; 8 bytes where binary
  double real();             ///< 8 bytes where binary; may be infinite or NaN
  /// A whole number in [0, most] of `what`; where not, says so. 8 bytes where binary and `wide`.
  std::int64_t count(const char* what, std::int64_t most, bool wide);

  [[noreturn]] void fail(const std::string& what) const;
  /// Bytes not read yet: no count of a file's parts can be larger.
  std::int64_t left() const { return static_cast<std::int64_t>(bytes_.size() - at_); }

 private:
  void skip_space();
  std::string_view word(const char* wanted);
  template <typename Number>
  Number raw();
  template <typename Number>
  Number parsed(const char* wanted);

  std::string path_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  bool binary_ = false;
  bool comments_ = false;
};

}  // namespace pliant
