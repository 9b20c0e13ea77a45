#include "solve/dynamics/centroidal_step.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/least_squares.h"
#include "base/math/se3.h"
#include "solve/dynamics/inverse_dynamics.h"

namespace retarget {
namespace {

constexpr std::size_t kFrameSize = 6;
constexpr std::size_t kBand = 3 * kFrameSize;  // Entries of a row up to the diagonal.
constexpr std::size_t kFixed = 2;              // Number of coefficients fixed at 0 at either end.
constexpr double kRho = 1.0 / (0.02 * 0.02);   // Residual 1 at an unexplained 2 % of the weight.

// Ratio of the gradient of the cost with a dead zone to its gradient without one.
double pull_share(const Vector6d& rest, double dead_zone) {
  const double norm = rest.norm();
  return norm > dead_zone ? 1.0 - dead_zone / norm : 0.0;
}

// Replaces `needed` by triangular means, whose weights fall to 0 at a distance of `reach` frames.
void average_needed(std::vector<CentroidalFrame>& frames, double reach) {
  const auto count = static_cast<int>(frames.size());
  // Number of frames on either side with non-zero weight.
  const auto last = static_cast<int>(std::ceil(reach)) - 1;
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
  // The unit of torque, W l, divided by g.
  const double inertia = scale.mass * scale.length;
  const double dt2 = scale.frame_time * scale.frame_time;
  // The residual is 1 at a displacement of 0.1 l, and at 0.048 m l^2 of the angular
  // quasi-coordinate.
  const double place = 1.0 / (0.1 * scale.length);
  const double turn = 1.0 / (0.048 * scale.mass * scale.length * scale.length);
  constexpr double kAcceleration = 0.1;  // Per (m/s^2)^2.
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
    // The wrench refers to the displaced centre of mass, so its torque changes by x cross F.
    coupling_[t].bottomLeftCorner<3, 3>() = -skew(frames[t].needed.head<3>()) / scale.length;
  }
}

// Returns the cost (half the weighted squares) and keeps intermediate results for assemble().
double CentroidalStep::evaluate(std::vector<CentroidalFrame>& frames,
                                const std::vector<Vector6d>& b) {
  double cost = 0.0;
  for (std::size_t t = 1; t + 1 < frames.size(); ++t) {
    CentroidalFrame& frame = frames[t];
    const Vector6d x = value(b, t), xdd = second(b, t);
    const Vector6d wrench =
        frame.needed + force_per_acceleration_.cwiseProduct(xdd) + coupling_[t] * x;
    double missing = 0.0;
    if (ConeProjector::explains(frame.cone, wrench, frame.dead_zone)) {
      rest_[t].setZero();  // A wrench inside the dead zone has no cost.
    } else {
      rest_[t] = projector_.project(frame.cone, wrench);
      // std::max would hide NaN.
      missing = rest_[t].norm() - frame.dead_zone;
      if (missing < 0.0) missing = 0.0;
      if (missing > 0.0) complement_[t] = projector_.complement();
    }
    cost += 0.5 * (kRho * frame.trust * missing * missing +
                   position_weight_.dot((x + frame.moved).cwiseAbs2()) +
                   acceleration_weight_.dot(xdd.cwiseAbs2()));
  }
  return cost;
}

// Assembles the banded Gauss-Newton Hessian and the negative gradient at the iterate of the last
// evaluate().
void CentroidalStep::assemble(const std::vector<CentroidalFrame>& frames,
                              const std::vector<Vector6d>& b) {
  system_.begin(frames.size() * kFrameSize, kBand);
  const Matrix6d per_second = force_per_acceleration_.asDiagonal();
  for (std::size_t t = 1; t + 1 < frames.size(); ++t) {
    const double rho = kRho * frames[t].trust * pull_share(rest_[t], frames[t].dead_zone);
    if (!(rho > 0.0)) {
      add_diagonals(t, Vector6d::Zero(), Vector6d::Zero(), frames[t].moved, b);
      continue;
    }
    const Matrix6d side = per_second + coupling_[t] / 6.0;
    const Matrix6d middle = -2.0 * per_second + 4.0 * coupling_[t] / 6.0;
    // The complement is a projector (up to ConeProjector's ridge), so its square is itself.
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

// Adds the position and acceleration terms, which couple only equal components, to the Hessian, and
// adds all terms of a frame to the negative gradient.
void CentroidalStep::add_diagonals(std::size_t frame, const Vector6d& side_pull,
                                   const Vector6d& middle_pull, const Vector6d& moved,
                                   const std::vector<Vector6d>& b) {
  constexpr std::array<double, 3> kValue = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
  constexpr std::array<double, 3> kSecond = {1.0, -2.0, 1.0};
  const Vector6d place = position_weight_.cwiseProduct(value(b, frame) + moved);
  const Vector6d xdd = acceleration_weight_.cwiseProduct(second(b, frame));
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t at = (frame - 1 + i) * kFrameSize;
    const Vector6d& pull = i == 1 ? middle_pull : side_pull;
    for (std::size_t k = 0; k < kFrameSize; ++k) {
      const auto component = static_cast<int>(k);
      system_.right()[at + k] -=
          pull[component] + kValue[i] * place[component] + kSecond[i] * xdd[component];
      double* const diagonal = system_.row(at + k) + at + k;
      for (std::size_t j = 0; j <= i; ++j) {
        *(diagonal - kFrameSize * (i - j)) +=
            position_weight_[component] * kValue[i] * kValue[j] +
            acceleration_weight_[component] * kSecond[i] * kSecond[j];
      }
    }
  }
}

// Adds to the lower triangle.
void CentroidalStep::add_block(std::size_t row, std::size_t column, const Matrix6d& block) {
  for (std::size_t i = 0; i < kFrameSize; ++i) {
    double* const entries = system_.row(row * kFrameSize + i) + column * kFrameSize;
    const std::size_t count = row == column ? i + 1 : kFrameSize;
    for (std::size_t j = 0; j < count; ++j) {
      entries[j] += block(static_cast<int>(i), static_cast<int>(j));
    }
  }
}

// The least-squares problem in the coefficients b, for damped_least_squares().
struct CentroidalStep::Descent {
  CentroidalStep& step;
  std::vector<CentroidalFrame>& frames;
  std::vector<Vector6d> b, tried = b;

  double cost() { return step.evaluate(frames, b); }
  void linearise() { step.assemble(frames, b); }
  std::optional<double> solve(double /*damping*/) {
    constexpr std::size_t kHeld = kFixed * kFrameSize;
    return step.system_.solve(kHeld, b.size() * kFrameSize - kHeld);
  }
  double try_step(double length) {
    for (std::size_t t = 0; t < b.size(); ++t) {
      tried[t] = b[t] + length * Eigen::Map<const Vector6d>(&step.system_.right()[t * kFrameSize]);
    }
    return step.evaluate(frames, tried);
  }
  void accept() { b.swap(tried); }
  void reject() {}
};

void CentroidalStep::find_unexplained(std::vector<CentroidalFrame>& frames,
                                      const CentroidalScale& scale) {
  constexpr double kMeanOver = 1.0 / 30.0;  // Seconds.
  average_needed(frames, kMeanOver / scale.frame_time);
  project_needed(frames);
}

void CentroidalStep::project_needed(std::vector<CentroidalFrame>& frames) {
  unexplained_before_.clear();
  for (CentroidalFrame& frame : frames) {
    unexplained_before_.push_back(projector_.project(frame.cone, frame.needed));
  }
}

std::vector<Vector6d> CentroidalStep::solve(std::vector<CentroidalFrame>& frames,
                                            const CentroidalScale& scale, int iterations) {
  const std::size_t count = frames.size();
  std::vector<Vector6d> x(count, Vector6d::Zero());
  accelerations_.assign(count, Vector6d::Zero());
  failed_ = false;
  if (count < 2 * kFixed + 1) return x;
  begin(frames, scale);
  rest_.resize(count);
  complement_.resize(count);
  // A line search replaces the damping. The descent ends at a step that no length makes successful.
  const LeastSquaresPolicy policy{.max_steps = iterations,
                                  .initial_damping = 0.0,
                                  .min_increased = 1.0,
                                  .max_damping = 1.0,
                                  .trials = 5,
                                  .shorten = 0.4,
                                  .relative_change = 1e-3};
  Descent problem{*this, frames, x};
  failed_ = damped_least_squares(problem, policy).status == LeastSquaresStatus::kNonFinite;
  if (failed_) return x;
  for (std::size_t t = 1; t + 1 < count; ++t) {
    x[t] = value(problem.b, t);
    accelerations_[t] = second(problem.b, t) / (scale.frame_time * scale.frame_time);
  }
  return x;
}

}  // namespace retarget
