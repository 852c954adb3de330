#pragma once

namespace pliant {

/// The same as in package.xml; a test compares them.
constexpr const char* kVersion = "0.1.0";

}  // namespace pliant
