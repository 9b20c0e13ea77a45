#include "solve/fit/symmetric_inverse.h"

#include <array>
#include <cstddef>

#include "base/math/four_doubles.h"

namespace retarget {
namespace {

constexpr int kBlock = kInverseBlock;

// kBlock rows of kBlock values.
template <class V>
using Block = std::array<V, kBlock>;

// Loads the block at `from` of a matrix with rows of `stride` values.
template <class V>
RETARGET_INLINE Block<V> load(const double* from, int stride) {
  return {V::load(from), V::load(from + stride), V::load(from + 2 * stride),
          V::load(from + 3 * stride)};
}

template <class V>
RETARGET_INLINE void store(const Block<V>& block, double* to, int stride) {
  for (int i = 0; i < kBlock; ++i) block[i].store(to + i * stride);
}

// Copies the lower triangle to the upper one.
template <class V>
RETARGET_INLINE void mirror(Block<V>& block) {
  for (int i = 0; i < kBlock; ++i) {
    for (int j = 0; j < i; ++j) block[j].set(i, block[i][j]);
  }
}

// Inverts a pivot block by unblocked sweeps. @return false if it is not positive definite.
template <class V>
RETARGET_INLINE bool invert(Block<V>& d) {
  for (int k = 0; k < kBlock; ++k) {
    const double pivot = d[k][k];
    if (!(pivot > 0.0)) return false;
    const double inverse = 1.0 / pivot;
    for (int i = 0; i < kBlock; ++i) {
      if (i == k) continue;
      const double factor = d[i][k] * inverse;
      d[i] = d[i] - V::all(factor) * d[k];
      d[i].set(k, -factor);
    }
    d[k] = d[k] * V::all(inverse);
    d[k].set(k, inverse);
  }
  return true;
}

// Columns of the pivot rows, before and after multiplication by the inverse of the pivot block.
// Both have rows of `size` values.
struct PivotRows {
  double* before;
  double* after;
  int size;
};

// @param from  kBlock columns of the pivot rows, starting at column j.
// @return these columns after the multiplication.
template <class V>
RETARGET_INLINE Block<V> multiply(const Block<V>& inverse, const Block<V>& from, int j,
                                  const PivotRows& rows) {
  Block<V> after;
  for (int i = 0; i < kBlock; ++i) {
    const V& d = inverse[i];
    after[i] = V::all(d[0]) * from[0] + V::all(d[1]) * from[1] + V::all(d[2]) * from[2] +
               V::all(d[3]) * from[3];
  }
  store(from, rows.before + j, rows.size);
  store(after, rows.after + j, rows.size);
  return after;
}

// Subtracts the product of pivot columns and pivot rows from kBlock rows, up to the diagonal. All
// blocks of these rows share the factors.
// @param k  the pivot; its columns stay.
// @param a  row i.
template <class V>
RETARGET_INLINE void subtract_products(const PivotRows& rows, int k, int i, double* a) {
  const int size = rows.size;
  std::array<Block<V>, kBlock> factors;
  for (int p = 0; p < kBlock; ++p) {
    for (int q = 0; q < kBlock; ++q) factors[p][q] = V::all(rows.before[i + p + q * size]);
  }
  for (int j = 0; j <= i; j += kBlock) {
    if (j == k) continue;
    const Block<V> row = load<V>(rows.after + j, size);
    for (int p = 0; p < kBlock; ++p) {
      V sum = V::load(a + p * size + j);
      for (int q = 0; q < kBlock; ++q) sum = sum - factors[p][q] * row[q];
      sum.store(a + p * size + j);
    }
  }
}

template <class V>
RETARGET_INLINE bool sweep_plain(double* a, int size, double* scratch) {
  const PivotRows rows{scratch, scratch + static_cast<std::ptrdiff_t>(kBlock) * size, size};
  const auto at = [&](int i, int j) { return a + static_cast<std::ptrdiff_t>(i) * size + j; };
  for (int k = 0; k < size; k += kBlock) {
    Block<V> inverse = load<V>(at(k, k), size);
    mirror(inverse);
    if (!invert(inverse)) return false;
    for (int j = 0; j < k; j += kBlock) {
      store(multiply(inverse, load<V>(at(k, j), size), j, rows), at(k, j), size);
    }
    for (int j = k + kBlock; j < size; j += kBlock) {
      Block<V> block = load<V>(at(j, k), size);
      transpose(block);
      block = multiply(inverse, block, j, rows);
      transpose(block);
      store(block, at(j, k), size);
    }
    for (int i = 0; i < size; i += kBlock) {
      if (i != k) subtract_products<V>(rows, k, i, at(i, 0));
    }
    for (V& row : inverse) row = -row;
    store(inverse, at(k, k), size);
  }
  for (int i = 0; i < size; i += kBlock) {
    Block<V> block = load<V>(at(i, i), size);
    mirror(block);
    store(block, at(i, i), size);
  }
  return true;
}

RETARGET_FOUR(sweep)

}  // namespace

bool negative_inverse(double* a, int size, double* scratch, bool wide) {
  return sweep(wide, a, size, scratch);
}

}  // namespace retarget
