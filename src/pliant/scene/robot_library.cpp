#include "pliant/scene/robot_library.h"

#include "pliant/math/error.h"

namespace pliant {

LoadedLibrary& robot_library() {
  static LoadedLibrary library("libpliant_robots.so");
  return library;
}

void throw_no_robot_library(const LoadedLibrary& library) {
  throw InputError("robots and packages: cannot load libpliant_robots.so, which reads them: " +
                   library.why_not() +
                   "; it is built and installed with Pliant: put it beside libpliant_core.so");
}

}  // namespace pliant
