#pragma once

#include <string>

namespace pliant {

/// A shared library that is opened while the program runs, for good. It is looked for beside the
/// library that this is a part of, wherever that is installed, and then where the system looks.
class LoadedLibrary {
 public:
  /// `name`: of its file, "libpliant_voxels.so".
  explicit LoadedLibrary(const char* name);

  /// Its function of the C name `symbol`; null where it has none or was not opened: then why_not()
  /// tells why.
  template <class Function>
  Function* find(const char* symbol) {
    return reinterpret_cast<Function*>(find_address(symbol));
  }
  const std::string& why_not() const { return why_not_; }

 private:
  void* find_address(const char* symbol);

  void* handle_;
  std::string why_not_;
};

}  // namespace pliant
