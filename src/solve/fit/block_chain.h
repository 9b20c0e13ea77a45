#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/math/aligned_allocator.h"
#include "base/math/simd.h"

namespace retarget {

/// Solves symmetric positive definite systems with a block-tridiagonal matrix whose off-diagonal
/// blocks are diagonal matrices:
///
///     C_t x_(t-1) + H_t x_t + C_(t+1) x_(t+1) = b_t.
///
/// Block elimination from the first block to the last, S_t = H_t - C_t S_(t-1)^-1 C_t, then back
/// substitution. It stores the lower triangle of -S_t^-1, because C S^-1 C only scales rows and
/// columns of the inverse.
class BlockChain {
 public:
  /// @param size  number of rows of a block, > 0.
  /// @param wide  use AVX2; results are identical to those without.
  explicit BlockChain(int size, bool wide = has_avx2());

  /// Starts a system of `blocks` blocks.
  void begin(int blocks);

  [[nodiscard]] int size() const { return size_; }
  /// Distance between consecutive rows of a block, in values.
  [[nodiscard]] int stride() const { return stride_; }
  /// H_t. The caller fills the lower triangle. eliminate() replaces it with minus the inverse of
  /// the eliminated block.
  [[nodiscard]] double* block(int t) { return inverse_.data() + block_size() * index(t); }
  /// b_t, filled by the caller.
  [[nodiscard]] double* right(int t) { return right_.data() + index(t) * index(stride_); }
  /// C_t, filled by the caller for t > 0.
  [[nodiscard]] double* coupling(int t) { return coupling_.data() + index(t) * index(stride_); }

  /// Eliminates block t, which the caller has filled. Call in ascending order of t.
  /// @return false if the block is not positive definite.
  [[nodiscard]] bool eliminate(int t);
  /// Computes the solution. Call after the last block is eliminated.
  void substitute();
  [[nodiscard]] std::span<const double> solution(int t) const {
    return {solution_.data() + index(t) * index(stride_), index(size_)};
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] std::size_t block_size() const { return index(stride_) * index(stride_); }

  int size_;
  int stride_;
  bool wide_;
  int blocks_ = 0;
  std::vector<double, AlignedAllocator<double>> inverse_, right_, coupling_, solution_, scratch_;
};

}  // namespace retarget
