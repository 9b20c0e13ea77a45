#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// A rigid transform `a_from_b`: maps coordinates in frame b to coordinates in frame a.
///
/// The rotation is a unit quaternion (Eigen stores xyzw; the constructor takes wxyz). Variable
/// names state the frames: `world_from_foot = world_from_pelvis * pelvis_from_foot`.
struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< Unit of length of the context.

  [[nodiscard]] Pose inverse() const {
    const Eigen::Quaterniond conjugate = rotation.conjugate();
    return {conjugate, -(conjugate * translation)};
  }
};

[[nodiscard]] inline Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
  return {a_from_b.rotation * b_from_c.rotation,
          a_from_b.translation + a_from_b.rotation * b_from_c.translation};
}

/// A point in frame b, seen from frame a.
[[nodiscard]] inline Eigen::Vector3d operator*(const Pose& a_from_b,
                                               const Eigen::Vector3d& point_in_b) {
  return a_from_b.translation + a_from_b.rotation * point_in_b;
}

}  // namespace retarget
