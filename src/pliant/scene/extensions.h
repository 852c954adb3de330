#pragma once

#include <string>

#include "pliant/effects/registry.h"
#include "pliant/math/version.h"
#include "pliant/solvers/registry.h"

/// In a shared library of another package: `extend` is a function without arguments that adds
/// effects and solvers (pliant::add_effect, add_solver). It is called when the library is loaded,
/// by pliant::load_extension() or because PLIANT_EXTENSIONS names it.
#define PLIANT_EXTENSION(extend)                                                   \
  extern "C" const char* pliant_extension_version() { return ::pliant::kVersion; } \
  extern "C" void pliant_extend() { extend(); }

namespace pliant {

/// Loads a shared library that has a PLIANT_EXTENSION, for good; one that is loaded already is left
/// alone. Before any scene is loaded, and not while another thread loads one. Throws InputError
/// where `file`, an absolute path, is none, or is of another version of Pliant, or a name that it
/// adds is taken.
void load_extension(const std::string& file);

/// Loads those that the environment variable PLIANT_EXTENSIONS names, absolute paths separated by
/// colons, once in a process. Called before a scene is loaded and registries are listed.
void load_extensions_of_environment();

}  // namespace pliant
