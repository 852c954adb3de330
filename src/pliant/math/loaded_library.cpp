#include "pliant/math/loaded_library.h"

#include <dlfcn.h>

namespace pliant {
namespace {

std::string last_fault() {
  const char* fault = dlerror();
  return fault == nullptr ? "no reason given" : fault;
}

}  // namespace

// The run path of the library that this is compiled into is its own folder.
LoadedLibrary::LoadedLibrary(const char* name) : handle_(dlopen(name, RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ == nullptr) why_not_ = last_fault();
}

void* LoadedLibrary::find_address(const char* symbol) {
  if (handle_ == nullptr) return nullptr;
  void* address = dlsym(handle_, symbol);
  if (address == nullptr) why_not_ = last_fault();
  return address;
}

}  // namespace pliant
