#pragma once

/// Loops that are compiled twice on x86-64: with baseline instructions and, for processors that
/// have it, with AVX2. Products and sums are never fused (AVX2 alone has no such instructions) and
/// loops keep their order, so both give the same bits.

#if defined(__GNUC__)
#define RETARGET_INLINE __attribute__((always_inline)) inline
#else
#define RETARGET_INLINE inline
#endif

// name(wide, arguments...) from name_plain(arguments...); the baseline is not inlined either, for
// in its callers GCC makes it a third slower
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

/// Whether the functions made by RETARGET_AVX2 may be called.
inline bool has_avx2() {
#if defined(__GNUC__) && defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

}  // namespace retarget
