#include "base/math/pentadiagonal.h"

namespace retarget {

PentadiagonalFit::PentadiagonalFit(std::size_t count)
    : diagonal_(count), next_(count), second_(count), right_(count) {}

void PentadiagonalFit::add_value(std::size_t i, double weight, double target) {
  diagonal_[i] += weight;
  right_[i] += weight * target;
}

void PentadiagonalFit::add_difference(std::size_t i, double weight, double target) {
  diagonal_[i] += weight;
  diagonal_[i + 1] += weight;
  next_[i] -= weight;
  right_[i] -= weight * target;
  right_[i + 1] += weight * target;
}

void PentadiagonalFit::add_second_difference(std::size_t i, double weight, double target) {
  diagonal_[i] += weight;
  diagonal_[i + 1] += 4.0 * weight;
  diagonal_[i + 2] += weight;
  next_[i] -= 2.0 * weight;
  next_[i + 1] -= 2.0 * weight;
  second_[i] += weight;
  right_[i] += weight * target;
  right_[i + 1] -= 2.0 * weight * target;
  right_[i + 2] += weight * target;
}

std::vector<double> PentadiagonalFit::solve() const {
  const std::size_t count = diagonal_.size();
  // L D L^T with a unit lower triangle of two diagonals
  std::vector<double> pivot(count), first(count), second(count), x(right_);
  for (std::size_t i = 0; i < count; ++i) {
    pivot[i] = diagonal_[i];
    double below = next_[i];
    if (i >= 1) {
      pivot[i] -= first[i - 1] * first[i - 1] * pivot[i - 1];
      below -= first[i - 1] * second[i - 1] * pivot[i - 1];
      x[i] -= first[i - 1] * x[i - 1];
    }
    if (i >= 2) {
      pivot[i] -= second[i - 2] * second[i - 2] * pivot[i - 2];
      x[i] -= second[i - 2] * x[i - 2];
    }
    first[i] = below / pivot[i];
    second[i] = second_[i] / pivot[i];
  }
  for (std::size_t i = count; i-- > 0;) {
    x[i] /= pivot[i];
    if (i + 1 < count) x[i] -= first[i] * x[i + 1];
    if (i + 2 < count) x[i] -= second[i] * x[i + 2];
  }
  return x;
}

std::vector<double> smoothed(const std::vector<double>& y, double strength) {
  PentadiagonalFit fit(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) fit.add_value(i, 1.0, y[i]);
  for (std::size_t i = 0; i + 2 < y.size(); ++i) fit.add_second_difference(i, strength, 0.0);
  return fit.solve();
}

}  // namespace retarget
