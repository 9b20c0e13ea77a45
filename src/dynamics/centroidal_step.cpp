#include "dynamics/centroidal_step.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynamics/inverse_dynamics.h"
#include "math/se3.h"

namespace retarget {
namespace {

constexpr int kBlock = 6;
constexpr int kBand = 3 * kBlock;             // the diagonal and what is left of it
constexpr int kFixed = 2;                     // frames at either end that stay
constexpr double kRho = 1.0 / (0.02 * 0.02);  // per share of the weight that is missing, squared
constexpr double kHold = 1e12;

}  // namespace

Vector6d CentroidalStep::value(const std::vector<Vector6d>& b, int frame) {
  const auto t = static_cast<std::size_t>(frame);
  return (b[t - 1] + 4.0 * b[t] + b[t + 1]) / 6.0;
}

Vector6d CentroidalStep::second(const std::vector<Vector6d>& b, int frame) {
  const auto t = static_cast<std::size_t>(frame);
  return b[t - 1] - 2.0 * b[t] + b[t + 1];
}

void CentroidalStep::begin(const std::vector<CentroidalFrame>& frames,
                           const CentroidalScale& scale) {
  scale_ = scale;
  const double inertia = scale.mass * scale.length;  // torque per weight and length: times 1 / g
  const double dt2 = scale.frame_time * scale.frame_time;
  // a tenth of l, and what that length makes of the mass
  const double place = 1.0 / (0.1 * scale.length);
  const double turn = 1.0 / (0.048 * scale.mass * scale.length * scale.length);
  constexpr double kAcceleration = 0.1;  // per (m/s^2)^2
  for (int k = 0; k < 3; ++k) {
    position_weight_[k] = place * place;
    position_weight_[3 + k] = turn * turn;
    acceleration_weight_[k] = kAcceleration / (dt2 * dt2);
    acceleration_weight_[3 + k] = kAcceleration / (inertia * inertia * dt2 * dt2);
    force_per_acceleration_[k] = 1.0 / (kGravity * dt2);
    force_per_acceleration_[3 + k] = 1.0 / (kGravity * inertia * dt2);
  }
  coupling_.assign(frames.size(), Matrix6d::Zero());
  for (std::size_t t = 0; t < frames.size(); ++t) {
    // the force acts where the centre of mass has gone: x cross F, F in weights
    coupling_[t].bottomLeftCorner<3, 3>() = -skew(frames[t].needed.head<3>()) / scale.length;
  }
}

// Half the cost; with derivatives the band holds the Gauss-Newton Hessian and right_ the gradient.
double CentroidalStep::evaluate(std::vector<CentroidalFrame>& frames,
                                const std::vector<Vector6d>& b, bool with_derivatives) {
  const auto count = static_cast<int>(frames.size());
  if (with_derivatives) {
    std::ranges::fill(band_, 0.0);
    std::ranges::fill(right_, 0.0);
  }
  double cost = 0.0;
  for (int t = 1; t + 1 < count; ++t) {
    CentroidalFrame& frame = frames[static_cast<std::size_t>(t)];
    const Matrix6d& coupling = coupling_[static_cast<std::size_t>(t)];
    const Vector6d x = value(b, t), xdd = second(b, t);
    const Vector6d wrench = frame.needed + force_per_acceleration_.cwiseProduct(xdd) + coupling * x;
    const Vector6d rest = projector_.project(frame.cone, wrench);
    const Vector6d place = x + frame.moved;
    const double rho = kRho * frame.trust;
    cost += 0.5 * (rho * rest.squaredNorm() + position_weight_.dot(place.cwiseAbs2()) +
                   acceleration_weight_.dot(xdd.cwiseAbs2()));
    if (!with_derivatives) continue;
    Rows wrench_rows, place_rows, second_rows;
    const Matrix6d one = Matrix6d::Identity();
    const Matrix6d per_second = force_per_acceleration_.asDiagonal();
    wrench_rows << per_second + coupling / 6.0, -2.0 * per_second + 4.0 * coupling / 6.0,
        per_second + coupling / 6.0;
    const Rows projected = projector_.complement() * wrench_rows;
    // the complement is a projector but for the ridge
    const Eigen::Matrix<double, 18, 18> block = rho * wrench_rows.transpose() * projected;
    const Eigen::Matrix<double, 18, 1> pull = rho * wrench_rows.transpose() * rest;
    const int first = kBlock * (t - 1);
    for (int i = 0; i < kBand; ++i) {
      double* const row = band_.data() + static_cast<std::ptrdiff_t>(first + i) * kBand;
      for (int j = 0; j <= i; ++j) row[kBand - 1 - i + j] += block(i, j);
      right_[static_cast<std::size_t>(first + i)] += pull[i];
    }
    // what concerns each variable alone
    constexpr std::array<double, 3> kValue = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
    constexpr std::array<double, 3> kSecond = {1.0, -2.0, 1.0};
    for (int k = 0; k < kBlock; ++k) {
      const double p = position_weight_[k], a = acceleration_weight_[k];
      for (std::size_t i = 0; i < 3; ++i) {
        const int at = first + kBlock * static_cast<int>(i) + k;
        double* const row = band_.data() + static_cast<std::ptrdiff_t>(at) * kBand;
        for (std::size_t j = 0; j <= i; ++j) {
          row[kBand - 1 - kBlock * static_cast<int>(i - j)] +=
              p * kValue[i] * kValue[j] + a * kSecond[i] * kSecond[j];
        }
        right_[static_cast<std::size_t>(at)] += p * kValue[i] * place[k] + a * kSecond[i] * xdd[k];
      }
    }
  }
  return cost;
}

// banded Cholesky; the direction of descent. False: not positive definite
bool CentroidalStep::step(std::vector<Vector6d>& direction) {
  const auto size = static_cast<int>(right_.size());
  const auto row = [&](int i) { return band_.data() + static_cast<std::ptrdiff_t>(i) * kBand; };
  const int held = kFixed * kBlock;
  for (int i = 0; i < size; ++i) {
    if (i >= held && i < size - held) continue;
    row(i)[kBand - 1] += kHold;
  }
  for (int i = 0; i < size; ++i) {
    double* const a = row(i);
    for (int j = std::max(0, i - kBand + 1); j <= i; ++j) {
      const double* const c = row(j);
      const int from = std::max({0, i - kBand + 1, j - kBand + 1});
      double sum = a[kBand - 1 - i + j];
      for (int l = from; l < j; ++l) sum -= a[kBand - 1 - i + l] * c[kBand - 1 - j + l];
      if (i == j) {
        if (!(sum > 0.0)) return false;
        a[kBand - 1] = std::sqrt(sum);
      } else {
        a[kBand - 1 - i + j] = sum / c[kBand - 1];
      }
    }
    double sum = -right_[static_cast<std::size_t>(i)];
    for (int l = std::max(0, i - kBand + 1); l < i; ++l) {
      sum -= a[kBand - 1 - i + l] * direction[static_cast<std::size_t>(l / kBlock)][l % kBlock];
    }
    direction[static_cast<std::size_t>(i / kBlock)][i % kBlock] = sum / a[kBand - 1];
  }
  for (int i = size - 1; i >= 0; --i) {
    const double* const a = row(i);
    double& value = direction[static_cast<std::size_t>(i / kBlock)][i % kBlock];
    value /= a[kBand - 1];
    for (int l = std::max(0, i - kBand + 1); l < i; ++l) {
      direction[static_cast<std::size_t>(l / kBlock)][l % kBlock] -= a[kBand - 1 - i + l] * value;
    }
  }
  return true;
}

void CentroidalStep::find_unexplained(std::vector<CentroidalFrame>& frames) {
  unexplained_before_.clear();
  for (CentroidalFrame& frame : frames) {
    unexplained_before_.push_back(projector_.project(frame.cone, frame.needed));
  }
}

std::vector<Vector6d> CentroidalStep::solve(std::vector<CentroidalFrame>& frames,
                                            const CentroidalScale& scale, int iterations) {
  constexpr int kTries = 5;
  constexpr double kShorter = 0.4, kEnough = 1e-3;
  const std::size_t count = frames.size();
  std::vector<Vector6d> x(count, Vector6d::Zero());
  find_unexplained(frames);
  if (count < 2 * kFixed + 1) return x;
  begin(frames, scale);
  band_.resize(count * kBlock * kBand);
  right_.resize(count * kBlock);
  std::vector<Vector6d> b(count, Vector6d::Zero()), direction = b, tried = b;
  for (int i = 0; i < iterations; ++i) {
    const double cost = evaluate(frames, b, true);
    if (!step(direction)) break;
    double length = 1.0, reached = cost;
    for (int k = 0; k < kTries && !(reached < cost); ++k, length *= kShorter) {
      for (std::size_t t = 0; t < count; ++t) tried[t] = b[t] + length * direction[t];
      reached = evaluate(frames, tried, false);
    }
    if (!(reached < cost)) break;
    b.swap(tried);
    if (cost - reached < kEnough * cost) break;
  }
  for (std::size_t t = 1; t + 1 < count; ++t) x[t] = value(b, static_cast<int>(t));
  return x;
}

}  // namespace retarget
