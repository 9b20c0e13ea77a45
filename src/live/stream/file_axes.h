#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>

#include "retarget/pose.h"

namespace retarget {

/// Possible units of files, in units per metre.
inline constexpr std::array kUnitsPerMetre = {1.0, 10.0, 100.0, 1000.0, 1.0 / 0.0254};

/// Lengths and axes of a stream or of a file.
struct SkeletonAxes {
  std::span<const Eigen::Vector3d> offsets;  ///< Offsets of the joints with a parent, in its axes.
  std::optional<Eigen::Vector3d> up;         ///< Up direction of the world; nothing: unknown.
};

/// Converts poses of a stream to the world, joint axes and unit of the user's file of the same
/// skeleton. The stream may have another up axis; its joint axes may turn with its world (a zero
/// pose is upright in both) or be those of the file.
class FileAxes {
 public:
  FileAxes() = default;
  /// @param file            has the joints of the stream, in the same order.
  /// @param metres_per_unit  unit of the stream; nothing: that of the file.
  FileAxes(const SkeletonAxes& stream, std::optional<double> metres_per_unit,
           const SkeletonAxes& file);

  /// Converts the pose of a root in the world.
  [[nodiscard]] Pose root(const Pose& world_from_joint) const {
    return {world_ * world_from_joint.rotation * joints_.conjugate(),
            scale_ * (world_ * world_from_joint.translation)};
  }
  /// Converts the pose of a joint relative to its parent.
  [[nodiscard]] Pose child(const Pose& parent_from_joint) const {
    return {joints_ * parent_from_joint.rotation * joints_.conjugate(),
            scale_ * (joints_ * parent_from_joint.translation)};
  }

 private:
  Eigen::Quaterniond world_ =
      Eigen::Quaterniond::Identity();  // World of the file from the stream's.
  Eigen::Quaterniond joints_ = Eigen::Quaterniond::Identity();  // Axes of every joint likewise.
  double scale_ = 1.0;
};

}  // namespace retarget
