#pragma once

#include <cstddef>
#include <new>

namespace retarget {

/// Allocates arrays at the start of a cache line. Vectors of 32 bytes then lie in a single line if
/// rows are multiples of 32 bytes long.
template <class T>
struct AlignedAllocator {
  using value_type = T;

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>& /*other*/) {}

  [[nodiscard]] T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kCacheLine));
  }
  /// Values without an initial value stay undefined, so that large arrays are not written twice.
  template <class U>
  void construct(U* value) {
    ::new (static_cast<void*>(value)) U;
  }
  void deallocate(T* values, std::size_t /*count*/) { ::operator delete(values, kCacheLine); }

  bool operator==(const AlignedAllocator&) const = default;

 private:
  static constexpr std::align_val_t kCacheLine{64};
};

}  // namespace retarget
