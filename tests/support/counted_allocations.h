#pragma once

// Replaces the global operator new to count allocations. Include it in a single file of a program.

#include <cstdlib>
#include <new>

namespace retarget {

/// Number of allocations of this thread.
inline thread_local long allocations = 0;

inline void* counted_allocation(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace retarget

[[gnu::noinline]] void* operator new(std::size_t size) {
  return retarget::counted_allocation(size);
}
[[gnu::noinline]] void* operator new[](std::size_t size) {
  return retarget::counted_allocation(size);
}
// Standard algorithms allocate optional scratch memory with the nothrow forms.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++retarget::allocations;
  return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  ++retarget::allocations;
  return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete[](void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
