#pragma once

#include <span>

/// Compiles loops twice on x86-64: with baseline instructions and with AVX2 for processors that
/// have it. Multiplications and additions are never fused (AVX2 alone has no FMA) and loops keep
/// their order, so both versions give identical bits.

#if defined(__GNUC__)
#define RETARGET_INLINE __attribute__((always_inline)) inline
#else
#define RETARGET_INLINE inline
#endif

// Defines name(wide, arguments...) from name_plain(arguments...). The baseline version is not
// inlined, because GCC makes it a third slower inside its callers.
#if defined(__GNUC__) && defined(__x86_64__)
#define RETARGET_AVX2(name)                                  \
  template <typename... A>                                   \
  __attribute__((target("avx2"))) auto name##_wide(A... a) { \
    return name##_plain(a...);                               \
  }                                                          \
  template <typename... A>                                   \
  __attribute__((noinline)) auto name##_baseline(A... a) {   \
    return name##_plain(a...);                               \
  }                                                          \
  template <typename... A>                                   \
  auto name(bool wide, A... a) {                             \
    return wide ? name##_wide(a...) : name##_baseline(a...); \
  }
#else
#define RETARGET_AVX2(name)    \
  template <typename... A>     \
  auto name(bool, A... a) {    \
    return name##_plain(a...); \
  }
#endif

namespace retarget {

/// Whether the processor supports the functions that RETARGET_AVX2 defines.
inline bool has_avx2() {
#if defined(__GNUC__) && defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

/// Computes the sines and cosines of many angles in vectors; the same bits as portable::sin_cos.
/// @param angles         radians.
/// @param sines, cosines  angles.size() values each.
void sin_cos_all(std::span<const double> angles, std::span<double> sines,
                 std::span<double> cosines);

}  // namespace retarget
