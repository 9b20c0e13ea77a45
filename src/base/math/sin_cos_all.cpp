#include "base/math/simd.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

constexpr std::size_t kLanes = 4;

// For small angles. The inner loop has a constant length, so the compiler vectorises it without a
// remainder.
RETARGET_INLINE void small_sin_cos_plain(const double* __restrict angles, std::size_t count,
                                         double* __restrict sines, double* __restrict cosines) {
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (std::size_t k = i; k < i + kLanes; ++k) {
      const auto [sine, cosine] = portable::sin_cos_of_small(angles[k]);
      sines[k] = sine;
      cosines[k] = cosine;
    }
  }
  for (; i < count; ++i) {
    const auto [sine, cosine] = portable::sin_cos_of_small(angles[i]);
    sines[i] = sine;
    cosines[i] = cosine;
  }
}
RETARGET_AVX2(small_sin_cos)

}  // namespace

void sin_cos_all(std::span<const double> angles, std::span<double> sines,
                 std::span<double> cosines) {
  const bool small = std::ranges::all_of(
      angles, [](double angle) { return std::abs(angle) <= portable::kMaxSmallAngle; });
  if (small) {
    small_sin_cos(has_avx2(), angles.data(), angles.size(), sines.data(), cosines.data());
    return;
  }
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const auto [sine, cosine] = portable::sin_cos(angles[i]);
    sines[i] = sine;
    cosines[i] = cosine;
  }
}

}  // namespace retarget
