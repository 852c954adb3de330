#ifndef PLIANT_GEOMETRY_GUARDED_IO_H_
#define PLIANT_GEOMETRY_GUARDED_IO_H_

#include <assimp/DefaultIOSystem.h>

#include <assimp/IOStream.hpp>

namespace pliant {

// Files for assimp, whose readers may ask for more of a truncated file forever: after a thousand
// reads past its end a read throws, and assimp reports that the file cannot be read.
class GuardedIo final : public Assimp::DefaultIOSystem {
 public:
  Assimp::IOStream* Open(const char* path, const char* mode = "rb") override;
};

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_GUARDED_IO_H_
