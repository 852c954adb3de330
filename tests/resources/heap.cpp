#include "resources/heap.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

namespace {

std::atomic<int> allocations{0};
std::atomic<std::size_t> in_use{0};
std::atomic<std::size_t> highest{0};

}  // namespace

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PLIANT_WATCHES_HEAP 1

namespace {

void* taken(void* memory) {
  if (memory == nullptr) return nullptr;
  ++allocations;
  const std::size_t now = in_use += malloc_usable_size(memory);
  std::size_t before = highest;
  while (now > before && !highest.compare_exchange_weak(before, now)) {
  }
  return memory;
}

void give(void* memory) {
  if (memory != nullptr) in_use -= malloc_usable_size(memory);
}

}  // namespace

// The standard library's operator new calls malloc, and so does Eigen.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) { return taken(__libc_malloc(size)); }
void* calloc(std::size_t number, std::size_t size) { return taken(__libc_calloc(number, size)); }
void* realloc(void* memory, std::size_t size) {
  give(memory);
  return taken(__libc_realloc(memory, size));
}
void* memalign(std::size_t alignment, std::size_t size) {
  return taken(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return taken(__libc_memalign(alignment, size));
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  void* block = taken(__libc_memalign(alignment, size));
  if (block == nullptr) return ENOMEM;
  *memory = block;
  return 0;
}
void free(void* memory) {
  give(memory);
  __libc_free(memory);
}
}
#endif

namespace pliant {

bool HeapWatch::works() {
#ifdef PLIANT_WATCHES_HEAP
  return true;
#else
  return false;
#endif
}

HeapWatch::HeapWatch() : start_(::in_use) {
  ::allocations = 0;
  highest = start_;
}

int HeapWatch::allocations() const { return ::allocations; }

std::size_t HeapWatch::peak() const { return highest - start_; }

std::size_t HeapWatch::in_use() const {
  const std::size_t now = ::in_use;
  return now > start_ ? now - start_ : 0;
}

}  // namespace pliant
