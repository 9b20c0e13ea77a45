#pragma once

#include <array>

#include "base/math/simd.h"

/// Vectors of four doubles for kernels whose blocks compilers do not keep in registers. Operations
/// work lane by lane and are never fused, so both kinds of vectors give identical bits.

// Defines name(wide, arguments...) from a template name_plain<V>(arguments...), where V is
// FourWide with AVX2, and FourInPairs without.
#if defined(__x86_64__)
#define RETARGET_FOUR(name)                                  \
  template <typename... A>                                   \
  __attribute__((target("avx2"))) auto name##_wide(A... a) { \
    return name##_plain<FourWide>(a...);                     \
  }                                                          \
  template <typename... A>                                   \
  __attribute__((noinline)) auto name##_baseline(A... a) {   \
    return name##_plain<FourInPairs>(a...);                  \
  }                                                          \
  template <typename... A>                                   \
  auto name(bool wide, A... a) {                             \
    return wide ? name##_wide(a...) : name##_baseline(a...); \
  }
#else
#define RETARGET_FOUR(name)                 \
  template <typename... A>                  \
  auto name(bool, A... a) {                 \
    return name##_plain<FourInPairs>(a...); \
  }
#endif

namespace retarget {

/// Four doubles in two vectors, which all processors have.
struct FourInPairs {
  using Pair [[gnu::vector_size(16)]] = double;
  using InMemory [[gnu::vector_size(16), gnu::aligned(8), gnu::may_alias]] = double;

  Pair low, high;

  RETARGET_INLINE static FourInPairs load(const double* from) {
    const auto* pairs = reinterpret_cast<const InMemory*>(from);
    return {pairs[0], pairs[1]};
  }
  RETARGET_INLINE static FourInPairs all(double x) { return {Pair{x, x}, Pair{x, x}}; }
  RETARGET_INLINE void store(double* to) const {
    auto* pairs = reinterpret_cast<InMemory*>(to);
    pairs[0] = low;
    pairs[1] = high;
  }
  RETARGET_INLINE double operator[](int i) const { return i < 2 ? low[i] : high[i - 2]; }
  RETARGET_INLINE void set(int i, double x) {
    Pair& pair = i < 2 ? low : high;
    pair[i % 2] = x;
  }
};

RETARGET_INLINE FourInPairs operator-(const FourInPairs& a) {
  return {-a.low, -a.high};
}
RETARGET_INLINE FourInPairs operator+(const FourInPairs& a, const FourInPairs& b) {
  return {a.low + b.low, a.high + b.high};
}
RETARGET_INLINE FourInPairs operator-(const FourInPairs& a, const FourInPairs& b) {
  return {a.low - b.low, a.high - b.high};
}
RETARGET_INLINE FourInPairs operator*(const FourInPairs& a, const FourInPairs& b) {
  return {a.low * b.low, a.high * b.high};
}

/// Transposes the 4 x 4 matrix with these rows.
RETARGET_INLINE void transpose(std::array<FourInPairs, 4>& rows) {
  const auto even = [](FourInPairs::Pair a, FourInPairs::Pair b) {
    return __builtin_shufflevector(a, b, 0, 2);
  };
  const auto odd = [](FourInPairs::Pair a, FourInPairs::Pair b) {
    return __builtin_shufflevector(a, b, 1, 3);
  };
  const auto [a, b, c, d] = rows;
  rows = {FourInPairs{even(a.low, b.low), even(c.low, d.low)},
          FourInPairs{odd(a.low, b.low), odd(c.low, d.low)},
          FourInPairs{even(a.high, b.high), even(c.high, d.high)},
          FourInPairs{odd(a.high, b.high), odd(c.high, d.high)}};
}

// GCC for Windows does not align the stack for vectors of 32 bytes (GCC bug 54412).
#if !defined(__x86_64__) || defined(_WIN32)
using FourWide = FourInPairs;
#else
/// Four doubles in one vector; only for functions that RETARGET_FOUR compiles with AVX2.
struct FourWide {
  using Vector [[gnu::vector_size(32)]] = double;
  using InMemory [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;

  Vector vector;

  RETARGET_INLINE static FourWide load(const double* from) {
    return {*reinterpret_cast<const InMemory*>(from)};
  }
  RETARGET_INLINE static FourWide all(double x) { return {Vector{x, x, x, x}}; }
  RETARGET_INLINE void store(double* to) const { *reinterpret_cast<InMemory*>(to) = vector; }
  RETARGET_INLINE double operator[](int i) const { return vector[i]; }
  RETARGET_INLINE void set(int i, double x) { vector[i] = x; }
};

RETARGET_INLINE FourWide operator-(const FourWide& a) {
  return {-a.vector};
}
RETARGET_INLINE FourWide operator+(const FourWide& a, const FourWide& b) {
  return {a.vector + b.vector};
}
RETARGET_INLINE FourWide operator-(const FourWide& a, const FourWide& b) {
  return {a.vector - b.vector};
}
RETARGET_INLINE FourWide operator*(const FourWide& a, const FourWide& b) {
  return {a.vector * b.vector};
}

RETARGET_INLINE void transpose(std::array<FourWide, 4>& rows) {
  auto& [a, b, c, d] = rows;
  const auto ab_even = __builtin_shufflevector(a.vector, b.vector, 0, 4, 2, 6);
  const auto ab_odd = __builtin_shufflevector(a.vector, b.vector, 1, 5, 3, 7);
  const auto cd_even = __builtin_shufflevector(c.vector, d.vector, 0, 4, 2, 6);
  const auto cd_odd = __builtin_shufflevector(c.vector, d.vector, 1, 5, 3, 7);
  a.vector = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b.vector = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c.vector = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d.vector = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}
#endif

}  // namespace retarget
