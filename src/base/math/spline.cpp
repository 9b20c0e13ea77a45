#include "retarget/spline.h"

#include <algorithm>

#include "retarget/so3.h"

namespace retarget {
namespace {

// The cubic from 0 with velocity v0 to `step` with velocity v1.
Eigen::Vector3d cubic_offset(const Eigen::Vector3d& step, const Eigen::Vector3d& v0,
                             const Eigen::Vector3d& v1, double s) {
  const double rest = 1.0 - s;
  return s * s * (3.0 - 2.0 * s) * step + s * rest * rest * v0 - s * s * rest * v1;
}

}  // namespace

std::vector<Eigen::Vector3d> spline_velocities(std::span<const Eigen::Vector3d> steps) {
  const std::size_t count = steps.size() + 1;
  if (count == 1) return {Eigen::Vector3d::Zero()};
  if (count == 2) return {steps[0], steps[0]};
  const std::size_t last = count - 1;
  if (count == 3) {
    return {1.5 * steps[0] - 0.5 * steps[1], 0.5 * (steps[0] + steps[1]),
            1.5 * steps[1] - 0.5 * steps[0]};
  }

  // Inner rows make second derivatives continuous:
  //   v[i-1] + 4 v[i] + v[i+1] = 3 (steps[i-1] + steps[i]).
  // The first row makes the third derivative continuous at the second sample:
  //   v[0] + 2 v[1] = (5 steps[0] + steps[1]) / 2.
  std::vector<Eigen::Vector3d> velocities(count);
  std::vector<double> upper(count);
  velocities[0] = 2.5 * steps[0] + 0.5 * steps[1];
  upper[0] = 2.0;
  for (std::size_t i = 1; i < last; ++i) {
    const double pivot = 4.0 - upper[i - 1];
    upper[i] = 1.0 / pivot;
    velocities[i] = (3.0 * (steps[i - 1] + steps[i]) - velocities[i - 1]) / pivot;
  }
  const Eigen::Vector3d end = 2.5 * steps[last - 1] + 0.5 * steps[last - 2];
  velocities[last] = (end - 2.0 * velocities[last - 1]) / (1.0 - 2.0 * upper[last - 1]);
  for (std::size_t i = last; i-- > 0;) velocities[i] -= upper[i] * velocities[i + 1];
  return velocities;
}

std::vector<Eigen::Vector3d> steps_between(std::span<const Eigen::Vector3d> points) {
  std::vector<Eigen::Vector3d> steps;
  for (std::size_t i = 1; i < points.size(); ++i) steps.emplace_back(points[i] - points[i - 1]);
  return steps;
}

std::vector<Eigen::Vector3d> steps_between(std::span<const Eigen::Quaterniond> rotations) {
  std::vector<Eigen::Vector3d> steps;
  for (std::size_t i = 1; i < rotations.size(); ++i) {
    steps.push_back(log_so3(rotations[i] * rotations[i - 1].conjugate()));
  }
  return steps;
}

double smooth_step(double from, double to, double value) {
  const double share = std::clamp((value - from) / (to - from), 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

Eigen::Vector3d interpolate_cubic(const Eigen::Vector3d& p0, const Eigen::Vector3d& v0,
                                  const Eigen::Vector3d& p1, const Eigen::Vector3d& v1, double s) {
  return p0 + cubic_offset(p1 - p0, v0, v1, s);
}

Eigen::Quaterniond interpolate_cubic(const Eigen::Quaterniond& q0, const Eigen::Vector3d& v0,
                                     const Eigen::Quaterniond& q1, const Eigen::Vector3d& v1,
                                     double s) {
  const Eigen::Vector3d step = log_so3(q1 * q0.conjugate());
  // Rate of the rotation vector at which the angular velocity at q1 is v1.
  const Eigen::Vector3d vector_rate = apply_left_jacobian_inverse_so3(step, v1);
  return (exp_so3(cubic_offset(step, v0, vector_rate, s)) * q0).normalized();
}

Eigen::Quaterniond interpolate_linear(const Eigen::Quaterniond& q0, const Eigen::Quaterniond& q1,
                                      double s) {
  return (exp_so3(s * log_so3(q1 * q0.conjugate())) * q0).normalized();
}

}  // namespace retarget
