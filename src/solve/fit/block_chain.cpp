#include "solve/fit/block_chain.h"

#include <algorithm>
#include <array>

#include "base/math/four_doubles.h"
#include "solve/fit/symmetric_inverse.h"

namespace retarget {
namespace {

// Computes y = sign * a x. Reads the lower triangle of `a` and the blocks on its diagonal, each
// entry once, because the blocks of a window do not fit into the cache.
template <class V>
RETARGET_INLINE void multiply_plain(const double* a, const double* x, double sign, int size,
                                    double* y) {
  for (int i = 0; i < size; i += kInverseBlock) {
    const double* const rows = a + static_cast<std::ptrdiff_t>(i) * size;
    std::array<V, kInverseBlock> factors, sums;
    for (int p = 0; p < kInverseBlock; ++p) factors[p] = V::all(sign * x[i + p]);
    sums.fill(V::all(0.0));
    for (int j = 0; j < i; j += kInverseBlock) {
      const V other = V::load(x + j);
      V above = V::load(y + j);
      for (int p = 0; p < kInverseBlock; ++p) {
        const V entries = V::load(rows + p * size + j);
        above = above + factors[p] * entries;
        sums[p] = sums[p] + entries * other;
      }
      above.store(y + j);
    }
    transpose(sums);
    V own = V::all(sign) * ((sums[0] + sums[1]) + (sums[2] + sums[3]));
    for (int p = 0; p < kInverseBlock; ++p) {
      own = own + factors[p] * V::load(rows + p * size + i);
    }
    own.store(y + i);
  }
}
RETARGET_FOUR(multiply)

// Adds c n c to h, with c diagonal. Covers the lower triangle rounded up to whole blocks.
RETARGET_INLINE void add_coupled_plain(const double* __restrict n, const double* __restrict c,
                                       int size, double* __restrict h) {
  for (int i = 0; i < size; ++i) {
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(i) * size;
    const int end = (i / kInverseBlock + 1) * kInverseBlock;
    const double factor = c[i];
    for (int j = 0; j < end; ++j) h[row + j] += factor * n[row + j] * c[j];
  }
}
RETARGET_AVX2(add_coupled)

}  // namespace

BlockChain::BlockChain(int size, bool wide)
    : size_(size),
      stride_((size + kInverseBlock - 1) / kInverseBlock * kInverseBlock),
      wide_(wide) {
  scratch_.resize(index(2 * kInverseBlock) * index(stride_));
}

void BlockChain::begin(int blocks) {
  blocks_ = blocks;
  const std::size_t rows = index(blocks) * index(stride_);
  inverse_.resize(index(blocks) * block_size());
  right_.assign(rows, 0.0);
  coupling_.assign(rows, 0.0);
  solution_.assign(rows, 0.0);
}

bool BlockChain::eliminate(int t) {
  double* const h = block(t);
  for (int i = size_; i < stride_; ++i) {
    std::fill_n(h + static_cast<std::ptrdiff_t>(i) * stride_, stride_, 0.0);
    h[static_cast<std::ptrdiff_t>(i) * stride_ + i] = 1.0;
  }
  if (t > 0) {
    const double* const c = coupling(t);
    add_coupled(wide_, block(t - 1), c, stride_, h);
    // The previous block contributes its partial solution, computed without this block.
    const double* const before = solution_.data() + index(t - 1) * index(stride_);
    double* const b = right(t);
    for (int j = 0; j < size_; ++j) b[j] -= c[j] * before[j];
  }
  if (!negative_inverse(h, stride_, scratch_.data(), wide_)) return false;
  multiply(wide_, h, right(t), -1.0, stride_, solution_.data() + index(t) * index(stride_));
  return true;
}

void BlockChain::substitute() {
  double* const coupled = scratch_.data();
  for (int t = blocks_ - 2; t >= 0; --t) {
    double* const x = solution_.data() + index(t) * index(stride_);
    const double* const next = x + stride_;
    const double* const c = coupling(t + 1);
    double* const correction = coupled + stride_;
    for (int j = 0; j < stride_; ++j) coupled[j] = c[j] * next[j];
    multiply(wide_, block(t), coupled, 1.0, stride_, correction);
    for (int j = 0; j < size_; ++j) x[j] += correction[j];
  }
}

}  // namespace retarget
