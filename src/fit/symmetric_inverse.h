#pragma once

namespace retarget {

/// Rows and columns are handled in blocks of this many.
inline constexpr int kInverseBlock = 4;

/// Minus the inverse of a symmetric positive definite matrix, in place, by sweeping blocks of four
/// pivots at a time (Goodnight, "A tutorial on the SWEEP operator", 1979): the sweeps touch one
/// triangle only and run along rows, so they become vector code.
///
/// @param a       size x size, rows next to each other; the lower triangle is read, both are
///                written. 16-byte aligned.
/// @param size    a multiple of kInverseBlock.
/// @param scratch 2 * kInverseBlock * size values.
/// @param wide    take the wider vectors; has_avx2() says whether the processor has them.
/// @return false where a pivot block is not positive definite; `a` is then of no use.
///
/// As every number comes of the same operations in the same order, bits are the same with and
/// without wide vectors.
[[nodiscard]] bool negative_inverse(double* a, int size, double* scratch, bool wide);

}  // namespace retarget
