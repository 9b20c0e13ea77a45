#include "dynamics/centroidal_step.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynamics/inverse_dynamics.h"
#include "math/se3.h"

namespace retarget {
namespace {

constexpr std::size_t kBlock = 6;
constexpr std::size_t kBand = 3 * kBlock;     // the diagonal and what is left of it
constexpr std::size_t kFixed = 2;             // coefficients at either end that are 0
constexpr double kRho = 1.0 / (0.02 * 0.02);  // per share of the weight that is missing, squared
constexpr double kHold = 1e12;                // of those, in terms of the largest diagonal
// of the weight; what is missing less than that pulls at nothing
constexpr double kDeadZone = 0.01;

// by how much the square of what is missing beyond the dead zone pulls less than the whole square
double pull_share(const Vector6d& rest) {
  const double norm = rest.norm();
  return norm > kDeadZone ? 1.0 - kDeadZone / norm : 0.0;
}

// Of what is needed: means with weights that fall to 0 at so many frames on either side.
void average_needed(std::vector<CentroidalFrame>& frames, double reach) {
  const auto count = static_cast<int>(frames.size());
  const auto last = static_cast<int>(std::ceil(reach)) - 1;  // on either side, with a weight
  if (last < 1) return;
  std::vector<Vector6d> means;
  means.reserve(frames.size());
  for (int t = 0; t < count; ++t) {
    Vector6d sum = Vector6d::Zero();
    double weights = 0.0;
    for (int k = std::max(-last, -t); k <= std::min(last, count - 1 - t); ++k) {
      const double weight = 1.0 - std::abs(k) / reach;
      sum += weight * frames[static_cast<std::size_t>(t + k)].needed;
      weights += weight;
    }
    means.emplace_back(sum / weights);
  }
  for (std::size_t t = 0; t < frames.size(); ++t) frames[t].needed = means[t];
}

}  // namespace

Vector6d CentroidalStep::value(const std::vector<Vector6d>& b, std::size_t t) {
  return (b[t - 1] + 4.0 * b[t] + b[t + 1]) / 6.0;
}

Vector6d CentroidalStep::second(const std::vector<Vector6d>& b, std::size_t t) {
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

// Half the cost; keeps what assemble needs of it.
double CentroidalStep::evaluate(std::vector<CentroidalFrame>& frames,
                                const std::vector<Vector6d>& b) {
  double cost = 0.0;
  for (std::size_t t = 1; t + 1 < frames.size(); ++t) {
    CentroidalFrame& frame = frames[t];
    const Vector6d x = value(b, t), xdd = second(b, t);
    const Vector6d wrench =
        frame.needed + force_per_acceleration_.cwiseProduct(xdd) + coupling_[t] * x;
    rest_[t] = projector_.project(frame.cone, wrench);
    complement_[t] = projector_.complement();
    const double missing = std::max(0.0, rest_[t].norm() - kDeadZone);
    cost += 0.5 * (kRho * frame.trust * missing * missing +
                   position_weight_.dot((x + frame.moved).cwiseAbs2()) +
                   acceleration_weight_.dot(xdd.cwiseAbs2()));
  }
  return cost;
}

// The band of the Gauss-Newton Hessian, and the gradient, where evaluate was called last.
void CentroidalStep::assemble(const std::vector<CentroidalFrame>& frames,
                              const std::vector<Vector6d>& b) {
  std::ranges::fill(band_, 0.0);
  std::ranges::fill(right_, 0.0);
  const Matrix6d per_second = force_per_acceleration_.asDiagonal();
  for (std::size_t t = 1; t + 1 < frames.size(); ++t) {
    const Matrix6d side = per_second + coupling_[t] / 6.0;
    const Matrix6d middle = -2.0 * per_second + 4.0 * coupling_[t] / 6.0;
    const double rho = kRho * frames[t].trust * pull_share(rest_[t]);
    // the complement is a projector but for the ridge
    const Matrix6d side_part = rho * complement_[t] * side;
    const Matrix6d middle_part = rho * complement_[t] * middle;
    const Matrix6d side_side = side.transpose() * side_part;
    const Matrix6d middle_side = middle.transpose() * side_part;
    const Matrix6d middle_middle = middle.transpose() * middle_part;
    const std::size_t first = t - 1;
    add_block(first, first, side_side);
    add_block(first + 1, first, middle_side);
    add_block(first + 1, first + 1, middle_middle);
    add_block(first + 2, first, side_side);
    add_block(first + 2, first + 1, middle_side.transpose());
    add_block(first + 2, first + 2, side_side);
    const Vector6d pull = rho * rest_[t];
    add_diagonals(t, side.transpose() * pull, middle.transpose() * pull, frames[t].moved, b);
  }
}

// what concerns each variable alone, and the gradient
void CentroidalStep::add_diagonals(std::size_t frame, const Vector6d& side_pull,
                                   const Vector6d& middle_pull, const Vector6d& moved,
                                   const std::vector<Vector6d>& b) {
  constexpr std::array<double, 3> kValue = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
  constexpr std::array<double, 3> kSecond = {1.0, -2.0, 1.0};
  const Vector6d place = position_weight_.cwiseProduct(value(b, frame) + moved);
  const Vector6d xdd = acceleration_weight_.cwiseProduct(second(b, frame));
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t at = (frame - 1 + i) * kBlock;
    const Vector6d& pull = i == 1 ? middle_pull : side_pull;
    for (std::size_t k = 0; k < kBlock; ++k) {
      const auto component = static_cast<int>(k);
      right_[at + k] +=
          pull[component] + kValue[i] * place[component] + kSecond[i] * xdd[component];
      double* const diagonal = band_.data() + (at + k) * kBand + kBand - 1;
      for (std::size_t j = 0; j <= i; ++j) {
        *(diagonal - kBlock * (i - j)) += position_weight_[component] * kValue[i] * kValue[j] +
                                          acceleration_weight_[component] * kSecond[i] * kSecond[j];
      }
    }
  }
}

// to the lower triangle, which the band holds row by row up to the diagonal
void CentroidalStep::add_block(std::size_t row, std::size_t column, const Matrix6d& block) {
  for (std::size_t i = 0; i < kBlock; ++i) {
    double* const entries = band_.data() + (row * kBlock + i) * kBand;
    const std::size_t left = kBand - 1 - kBlock * (row - column) - i;
    const std::size_t count = row == column ? i + 1 : kBlock;
    for (std::size_t j = 0; j < count; ++j) {
      entries[left + j] += block(static_cast<int>(i), static_cast<int>(j));
    }
  }
}

// banded Cholesky; the direction of descent. False: not positive definite
bool CentroidalStep::step(std::vector<Vector6d>& direction) {
  const std::size_t size = right_.size(), held = kFixed * kBlock;
  // where entry (i, 0) of the matrix would stand in the band
  const auto row = [&](std::size_t i) {
    return band_.data() + static_cast<std::ptrdiff_t>(i * kBand + kBand - 1 - i);
  };
  const auto first = [](std::size_t i) { return i < kBand ? 0 : i - kBand + 1; };
  double largest = 0.0;
  for (std::size_t i = 0; i < size; ++i) largest = std::max(largest, row(i)[i]);
  for (std::size_t i = 0; i < held; ++i) {
    row(i)[i] += kHold * largest;
    row(size - 1 - i)[size - 1 - i] += kHold * largest;
  }
  std::vector<double>& y = right_;  // becomes the solution
  for (std::size_t i = 0; i < size; ++i) {
    double* const a = row(i);
    for (std::size_t j = first(i); j < i; ++j) {
      const double* const c = row(j);
      double sum = a[j];
      for (std::size_t k = first(i); k < j; ++k) sum -= a[k] * c[k];
      a[j] = sum / c[j];
    }
    double pivot = a[i], value = -y[i];
    for (std::size_t k = first(i); k < i; ++k) {
      pivot -= a[k] * a[k];
      value -= a[k] * y[k];
    }
    if (!(pivot > 0.0)) return false;
    a[i] = std::sqrt(pivot);
    y[i] = value / a[i];
  }
  for (std::size_t i = size; i-- > 0;) {
    const double* const a = row(i);
    y[i] /= a[i];
    for (std::size_t k = first(i); k < i; ++k) y[k] -= a[k] * y[i];
  }
  for (std::size_t t = 0; t < direction.size(); ++t) {
    direction[t] = Eigen::Map<const Vector6d>(y.data() + t * kBlock);
  }
  return true;
}

void CentroidalStep::find_unexplained(std::vector<CentroidalFrame>& frames,
                                      const CentroidalScale& scale) {
  constexpr double kMeanOver = 1.0 / 30.0;  // s
  average_needed(frames, kMeanOver / scale.frame_time);
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
  accelerations_.assign(count, Vector6d::Zero());
  if (count < 2 * kFixed + 1) return x;
  begin(frames, scale);
  band_.resize(count * kBlock * kBand);
  right_.resize(count * kBlock);
  rest_.resize(count);
  complement_.resize(count);
  std::vector<Vector6d> b(count, Vector6d::Zero()), direction = b, tried = b;
  double cost = evaluate(frames, b);
  for (int i = 0; i < iterations; ++i) {
    assemble(frames, b);
    if (!step(direction)) break;
    double length = 1.0, reached = cost;
    for (int k = 0; k < kTries && !(reached < cost); ++k, length *= kShorter) {
      for (std::size_t t = 0; t < count; ++t) tried[t] = b[t] + length * direction[t];
      reached = evaluate(frames, tried);
    }
    if (!(reached < cost)) break;
    b.swap(tried);
    const double decrease = cost - reached;
    cost = reached;
    if (decrease < kEnough * (cost + decrease)) break;
  }
  for (std::size_t t = 1; t + 1 < count; ++t) {
    x[t] = value(b, t);
    accelerations_[t] = second(b, t) / (scale.frame_time * scale.frame_time);
  }
  return x;
}

}  // namespace retarget
