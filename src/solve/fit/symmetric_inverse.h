#pragma once

namespace retarget {

/// Size of the blocks of rows and columns that are swept together.
inline constexpr int kInverseBlock = 4;

/// Replaces a symmetric positive definite matrix by minus its inverse. Sweeps blocks of four pivots
/// at a time (Goodnight, "A tutorial on the SWEEP operator", 1979): the sweeps touch only one
/// triangle.
///
/// @param a        size x size, row-major, 8-byte aligned. Reads the lower triangle; writes it and
///     the whole blocks of kInverseBlock rows and columns on the diagonal.
/// @param size     a multiple of kInverseBlock.
/// @param scratch  2 * kInverseBlock * size values.
/// @param wide     use AVX2; requires has_avx2().
/// @return false if a pivot block is not positive definite; `a` is then unusable.
///
/// Every element results from the same operations in the same order with and without AVX2, so both
/// give identical results.
[[nodiscard]] bool negative_inverse(double* a, int size, double* scratch, bool wide);

}  // namespace retarget
