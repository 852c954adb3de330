#ifndef PLIANT_GEOMETRY_ATOMIC_FILE_H_
#define PLIANT_GEOMETRY_ATOMIC_FILE_H_

#include <string>

namespace pliant {

// Replaces the file at `path` by `bytes`: readers see the old file or the new one, never a part,
// also after a crash. Throws InputError, saying why, when it cannot be written.
void write_file_atomically(const std::string& path, const std::string& bytes);

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_ATOMIC_FILE_H_
