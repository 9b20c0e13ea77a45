#pragma once

#include <cstdint>
#include <string>

namespace retarget {

/// Appends the `size` least significant bytes of a number, the least significant one first.
inline void append_little_endian(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i));
}

}  // namespace retarget
