#include "solve/fit/symmetric_inverse.h"

#include <array>
#include <cstddef>

#include "base/math/simd.h"

namespace retarget {
namespace {

constexpr int kBlock = kInverseBlock;
using Block = std::array<std::array<double, kBlock>, kBlock>;

// Inverts a pivot block by unblocked sweeps. @return false if it is not positive definite.
RETARGET_INLINE bool invert(Block& d) {
  for (int k = 0; k < kBlock; ++k) {
    const double pivot = d[k][k];
    if (!(pivot > 0.0)) return false;
    const double inverse = 1.0 / pivot;
    std::array<double, kBlock> column{};
    for (int i = 0; i < kBlock; ++i) column[i] = d[i][k];
    for (int i = 0; i < kBlock; ++i) {
      if (i == k) continue;
      const double factor = column[i] * inverse;
      for (int j = 0; j < kBlock; ++j) {
        if (j != k) d[i][j] -= factor * d[k][j];
      }
      d[i][k] = -factor;
    }
    for (int j = 0; j < kBlock; ++j) d[k][j] *= inverse;
    d[k][k] = inverse;
  }
  return true;
}

// Writes the transpose of the 4 x 4 block at `from` to `to`.
RETARGET_INLINE void transpose(const double* __restrict from, int from_stride,
                               double* __restrict to, int to_stride) {
  for (int i = 0; i < kBlock; ++i) {
    for (int j = 0; j < kBlock; ++j) to[i * to_stride + j] = from[j * from_stride + i];
  }
}

// Subtracts the product of the pivot columns and rows from rows i and i + 1, columns [0, count).
// `count` is a multiple of kBlock: inner loops of constant length vectorise without remainders.
RETARGET_INLINE void subtract_product(double* __restrict row0, double* __restrict row1,
                                      const double* __restrict b, const double* __restrict r, int i,
                                      int size, int count) {
  const double *r0 = r, *r1 = r + size, *r2 = r1 + size, *r3 = r2 + size;
  const double f0 = b[i], f1 = b[size + i], f2 = b[2 * size + i], f3 = b[3 * size + i];
  const double g0 = b[i + 1], g1 = b[size + i + 1], g2 = b[2 * size + i + 1],
               g3 = b[3 * size + i + 1];
  for (int j = 0; j < count; j += kBlock) {
    for (int c = j; c < j + kBlock; ++c) {
      row0[c] = row0[c] - f0 * r0[c] - f1 * r1[c] - f2 * r2[c] - f3 * r3[c];
      row1[c] = row1[c] - g0 * r0[c] - g1 * r1[c] - g2 * r2[c] - g3 * r3[c];
    }
  }
}

RETARGET_INLINE bool sweep_plain(double* a, int size, double* scratch) {
  double* const b = scratch;
  double* const r = scratch + static_cast<std::ptrdiff_t>(kBlock) * size;
  for (int k = 0; k < size; k += kBlock) {
    Block d;
    for (int p = 0; p < kBlock; ++p) {
      for (int q = 0; q <= p; ++q) d[p][q] = d[q][p] = a[(k + p) * size + k + q];
    }
    if (!invert(d)) return false;
    // `b` receives the pivot rows; `r` receives them multiplied by the inverse of the pivot block.
    for (int p = 0; p < kBlock; ++p) {
      double* const row = b + p * size;
      const double* const from = a + (k + p) * size;
      for (int j = 0; j < k; ++j) row[j] = from[j];
      for (int j = k; j < k + kBlock; ++j) row[j] = 0.0;
    }
    for (int j = k + kBlock; j < size; j += kBlock) transpose(a + j * size + k, size, b + j, size);
    for (int p = 0; p < kBlock; ++p) {
      double* __restrict row = r + p * size;
      const double* __restrict b0 = b, *b1 = b + size, *b2 = b1 + size, *b3 = b2 + size;
      const double d0 = d[p][0], d1 = d[p][1], d2 = d[p][2], d3 = d[p][3];
      for (int j = 0; j < size; j += kBlock) {
        for (int c = j; c < j + kBlock; ++c)
          row[c] = d0 * b0[c] + d1 * b1[c] + d2 * b2[c] + d3 * b3[c];
      }
    }
    for (int i = 0; i < size; i += kBlock) {
      if (i == k) continue;
      for (int p = 0; p < kBlock; p += 2) {
        subtract_product(a + (i + p) * size, a + (i + p + 1) * size, b, r, i + p, size, i + kBlock);
      }
    }
    for (int p = 0; p < kBlock; ++p) {
      double* const row = a + (k + p) * size;
      for (int j = 0; j < k; ++j) row[j] = r[p * size + j];
      for (int q = 0; q < kBlock; ++q) row[k + q] = -d[p][q];
    }
    for (int j = k + kBlock; j < size; j += kBlock) transpose(r + j, size, a + j * size + k, size);
  }
  for (int i = 0; i < size; i += kBlock) {
    for (int j = 0; j < i; j += kBlock) transpose(a + i * size + j, size, a + j * size + i, size);
    for (int p = 0; p < kBlock; ++p) {
      for (int q = 0; q < p; ++q) a[(i + q) * size + i + p] = a[(i + p) * size + i + q];
    }
  }
  return true;
}

RETARGET_AVX2(sweep)

}  // namespace

bool negative_inverse(double* a, int size, double* scratch, bool wide) {
  return sweep(wide, a, size, scratch);
}

}  // namespace retarget
