#pragma once

#include <cstddef>

namespace retarget {

/// Converts an index to the size type of the standard containers.
[[nodiscard]] constexpr std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

[[nodiscard]] constexpr double square(double x) {
  return x * x;
}

}  // namespace retarget
