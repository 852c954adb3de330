#include "pliant/geometry/io/guarded_io.h"

#include <memory>
#include <stdexcept>
#include <utility>

#include "pliant/geometry/io/readable_file.h"

namespace pliant {
namespace {

class GuardedStream final : public Assimp::IOStream {
 public:
  explicit GuardedStream(std::unique_ptr<Assimp::IOStream> file) : file_(std::move(file)) {}

  std::size_t Read(void* buffer, std::size_t size, std::size_t count) override {
    constexpr int kPatience = 1000;
    const std::size_t read = file_->Read(buffer, size, count);
    empty_reads_ = read == 0 ? empty_reads_ + 1 : 0;
    if (empty_reads_ > kPatience) throw std::runtime_error("the file ends too early");
    return read;
  }
  std::size_t Write(const void* buffer, std::size_t size, std::size_t count) override {
    return file_->Write(buffer, size, count);
  }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    return file_->Seek(offset, origin);
  }
  std::size_t Tell() const override { return file_->Tell(); }
  std::size_t FileSize() const override { return file_->FileSize(); }
  void Flush() override { file_->Flush(); }

 private:
  std::unique_ptr<Assimp::IOStream> file_;
  int empty_reads_ = 0;  // in a row
};

}  // namespace

bool GuardedIo::Exists(const char* path) const { return why_no_part(mesh_, path).empty(); }

Assimp::IOStream* GuardedIo::Open(const char* path, const char* mode) {
  if (!Exists(path)) return nullptr;
  std::unique_ptr<Assimp::IOStream> file(Assimp::DefaultIOSystem::Open(path, mode));
  return file ? new GuardedStream(std::move(file)) : nullptr;
}

}  // namespace pliant
