#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "retarget/trigonometry.h"

namespace retarget {

/// rotation := rotation * (turn about coordinate axis 0, 1 or 2), given the sine and cosine of half
/// the angle.
inline void rotate_about(Eigen::Quaterniond& rotation, int axis,
                         const portable::SineCosine& of_half_angle) {
  const auto [s, c] = of_half_angle;
  // Eigen stores x, y, z, w. Axes j and k follow `axis` cyclically.
  double* q = rotation.coeffs().data();
  const int j = axis == 2 ? 0 : axis + 1;
  const int k = axis == 0 ? 2 : axis - 1;
  const double w = q[3] * c - q[axis] * s;
  const double i = q[axis] * c + q[3] * s;
  const double along_j = q[j] * c + q[k] * s;
  q[k] = q[k] * c - q[j] * s;
  q[j] = along_j;
  q[axis] = i;
  q[3] = w;
}

/// rotation := rotation * (turn by `degrees` about coordinate axis 0, 1 or 2).
/// @pre |degrees| < 1e15
inline void rotate_about(Eigen::Quaterniond& rotation, int axis, double degrees) {
  rotate_about(rotation, axis, portable::sin_cos_of_half_degrees(degrees));
}

/// Decomposes `rotation` into Euler angles in degrees for turns about `axes` (0, 1, 2), composed
/// left to right (intrinsic). This is the inverse of rotate_about over all axes.
///
/// `axes` may have any length and may repeat an axis; turns that are not needed stay at 0. Of all
/// solutions the one nearest to `nearest_to` is returned, so that curves do not jump by 180 or 360
/// degrees between frames. In gimbal lock, where the first and the last turn share an axis, the
/// change is split evenly between them. With fewer than three different turns, some rotations are
/// not reachable.
///
/// Method: Bernardes and Viollet, "Quaternion to Euler angles conversion: a direct, general and
/// computationally efficient method", PLoS ONE 17(11), 2022; exact in gimbal lock.
///
/// @param rotation    a unit quaternion.
/// @param nearest_to  angles of the previous frame, or zeros; same size as axes.
/// @param angles      output; same size as axes.
/// @return the angle in degrees between `rotation` and the rotation that the angles give.
double euler_angles(const Eigen::Quaterniond& rotation, std::span<const int> axes,
                    std::span<const double> nearest_to, std::span<double> angles);

}  // namespace retarget
