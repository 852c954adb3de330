#ifndef PLIANT_GEOMETRY_GUARDED_IO_H_
#define PLIANT_GEOMETRY_GUARDED_IO_H_

#include <assimp/DefaultIOSystem.h>

#include <assimp/IOStream.hpp>
#include <string>
#include <utility>

namespace pliant {

// Files for assimp, whose readers may ask for more of a truncated file forever: after a thousand
// reads past its end a read throws, and assimp reports that the file cannot be read. Of the files
// that a mesh names it opens regular ones in the folder of the mesh and below: a name may be any
// path, a pipe's too.
class GuardedIo final : public Assimp::DefaultIOSystem {
 public:
  explicit GuardedIo(std::string mesh) : mesh_(std::move(mesh)) {}
  bool Exists(const char* path) const override;
  Assimp::IOStream* Open(const char* path, const char* mode = "rb") override;

 private:
  std::string mesh_;
};

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_GUARDED_IO_H_
