#include "formats/bvh/euler_angles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "retarget/so3.h"

namespace retarget {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
// Below this value, the sum or difference of the outer angles does not affect the rotation.
constexpr double kGimbalLock = 1e-12;

using Angles = std::array<double, 3>;

// The equivalent angle in degrees that is nearest to `goal`.
double nearest_turn(double angle, double goal) {
  return angle + 360.0 * std::round((goal - angle) / 360.0);
}

double distance(const Angles& a, const Angles& b) {
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

// 1 if j follows i cyclically, otherwise -1.
double handedness(int i, int j) {
  return (i + 1) % 3 == j ? 1.0 : -1.0;
}

double length(double x, double y) {
  return std::sqrt(x * x + y * y);
}

// Proper Euler angles: turns about i, j and i again.
Angles proper_angles(const Eigen::Quaterniond& rotation, int i, int j, const Angles& goal) {
  const auto& q = rotation.coeffs();
  const int k = 3 - i - j;
  const double w = q[3];
  const double out_of_plane = handedness(i, j) * q[k];
  const double cosine = length(w, q[i]);
  const double sine = length(q[j], out_of_plane);
  const double sum =
      cosine > kGimbalLock ? 2.0 * kDegrees * portable::atan2(q[i], w) : goal[0] + goal[2];
  const double difference =
      sine > kGimbalLock ? 2.0 * kDegrees * portable::atan2(out_of_plane, q[j]) : goal[0] - goal[2];
  const double middle = 2.0 * kDegrees * portable::atan2(sine, cosine);
  const double first = (sum + difference) / 2.0;
  const double last = (sum - difference) / 2.0;

  // Negating the middle turn and adding 180 degrees to both outer turns gives the same rotation.
  Angles near = {nearest_turn(first, goal[0]), nearest_turn(middle, goal[1]),
                 nearest_turn(last, goal[2])};
  const Angles far = {nearest_turn(first + 180.0, goal[0]), nearest_turn(-middle, goal[1]),
                      nearest_turn(last + 180.0, goal[2])};
  return distance(far, goal) < distance(near, goal) ? far : near;
}

// Three different axes: a quarter turn about j maps the last axis onto the first one.
Angles different_angles(const Eigen::Quaterniond& rotation, int i, int j, const Angles& goal) {
  const double sign = -handedness(i, j);
  Eigen::Quaterniond turned = rotation;
  rotate_about(turned, j, 90.0);
  const Angles angles = proper_angles(turned, i, j, {goal[0], goal[1] + 90.0, sign * goal[2]});
  return {angles[0], angles[1] - 90.0, sign * angles[2]};
}

// Two turns about different axes. If the rotation is not reachable, returns the nearest one that
// is.
Angles two_angles(const Eigen::Quaterniond& rotation, int i, int j, const Angles& goal) {
  const auto& q = rotation.coeffs();
  const double out_of_plane = handedness(i, j) * q[3 - i - j];
  const bool small_second = length(q[3], q[i]) >= length(q[j], out_of_plane);
  const double half =
      small_second ? portable::atan2(q[i], q[3]) : portable::atan2(out_of_plane, q[j]);
  const double first = nearest_turn(2.0 * kDegrees * half, goal[0]);
  Eigen::Quaterniond rest = Eigen::Quaterniond::Identity();
  rotate_about(rest, i, -first);
  rest = rest * rotation;
  const double second = 2.0 * kDegrees * portable::atan2(rest.coeffs()[j], rest.w());
  return {first, nearest_turn(second, goal[1]), 0.0};
}

}  // namespace

double euler_angles(const Eigen::Quaterniond& rotation, std::span<const int> axes,
                    std::span<const double> nearest_to, std::span<double> angles) {
  std::ranges::fill(angles, 0.0);

  // Indices of the turns to solve for: at most three, no two consecutive ones about the same axis.
  std::array<std::size_t, 3> used{};
  std::size_t count = 0;
  for (std::size_t at = 0; at < axes.size() && count < used.size(); ++at) {
    if (count == 0 || axes[at] != axes[used[count - 1]]) used[count++] = at;
  }
  Angles goal{};
  for (std::size_t n = 0; n < count; ++n) goal[n] = nearest_to[used[n]];

  Angles found{};
  if (count == 1) {
    const double angle =
        2.0 * kDegrees * portable::atan2(rotation.coeffs()[axes[used[0]]], rotation.w());
    found[0] = nearest_turn(angle, goal[0]);
  } else if (count == 2) {
    found = two_angles(rotation, axes[used[0]], axes[used[1]], goal);
  } else if (count == 3 && axes[used[0]] == axes[used[2]]) {
    found = proper_angles(rotation, axes[used[0]], axes[used[1]], goal);
  } else if (count == 3) {
    found = different_angles(rotation, axes[used[0]], axes[used[1]], goal);
  }
  for (std::size_t n = 0; n < count; ++n) angles[used[n]] = found[n];

  Eigen::Quaterniond reached = Eigen::Quaterniond::Identity();
  for (std::size_t at = 0; at < axes.size(); ++at) rotate_about(reached, axes[at], angles[at]);
  return log_so3(rotation.conjugate() * reached).norm() * kDegrees;
}

}  // namespace retarget
