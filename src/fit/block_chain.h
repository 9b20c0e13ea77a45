#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fit/simd.h"

namespace retarget {

/// Solves symmetric positive definite systems whose blocks form a chain: block t is coupled with
/// block t - 1 by a diagonal matrix alone,
///
///     C_t x_(t-1) + H_t x_t + C_(t+1) x_(t+1) = b_t.
///
/// Elimination from the first block to the last, S_t = H_t - C_t S_(t-1)^-1 C_t, then back; every
/// S_t^-1 is kept.
class BlockChain {
 public:
  /// @param size  of a block, more than 0.
  /// @param wide  use wide vectors; results are the same.
  explicit BlockChain(int size, bool wide = has_avx2());

  /// Begins a system of so many blocks.
  void begin(int blocks);

  [[nodiscard]] int size() const { return size_; }
  /// From a row of a block to the next.
  [[nodiscard]] int stride() const { return stride_; }
  /// H_t, to be filled (the lower triangle counts), then the inverse.
  [[nodiscard]] double* block(int t) { return inverse_.data() + block_size() * index(t); }
  /// b_t, to be filled.
  [[nodiscard]] double* right(int t) { return right_.data() + index(t) * index(stride_); }
  /// C_t, to be filled for t > 0.
  [[nodiscard]] double* coupling(int t) { return coupling_.data() + index(t) * index(stride_); }

  /// Eliminates block t, which must be filled; blocks one after the other.
  /// @return false where it is not positive definite.
  [[nodiscard]] bool eliminate(int t);
  /// After the last block was eliminated.
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
  std::vector<double> inverse_, right_, coupling_, solution_, scratch_;
};

}  // namespace retarget
