#pragma once

#include <cstddef>

namespace retarget {

/// An index for the standard containers.
[[nodiscard]] constexpr std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

[[nodiscard]] constexpr double square(double x) {
  return x * x;
}

}  // namespace retarget
