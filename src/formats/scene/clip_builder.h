#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/scene/scene.h"
#include "retarget/clip.h"
#include "retarget/pose.h"

namespace retarget {

/// World transform of a node. `rotation` is the product of the rotations along the path, so that
/// non-uniform scale does not skew it.
struct NodePlace {
  Eigen::Affine3d world_from_node = Eigen::Affine3d::Identity();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// Composes the transforms of a parent and a child. Negative scale on two axes counts as half a
/// turn.
[[nodiscard]] NodePlace place_below(const NodePlace& parent, const NodeTransform& parent_from_node);

/// Whether the scale mirrors space; false for NaN and 0.
[[nodiscard]] bool is_mirrored(const NodeTransform& transform);

/// Whether all numbers are finite and the quaternion is valid.
[[nodiscard]] bool is_sound(const NodeTransform& transform);

/// The rotation of a matrix with nearly orthogonal columns.
[[nodiscard]] Eigen::Quaterniond rotation_of(const Eigen::Matrix3d& matrix);

/// Decomposes a matrix into translation, rotation and scale. A mirroring matrix gives a negative
/// scale on the third axis.
[[nodiscard]] NodeTransform decomposed(const Eigen::Affine3d& affine);

/// The bind pose if it is usable: finite, non-degenerate, not mirrored.
[[nodiscard]] std::optional<Eigen::Affine3d> usable_bind(const Eigen::Affine3d& affine);

/// A joint of a skeleton, given by its world pose in the rest pose.
struct WorldJoint {
  std::string name;
  int parent = -1;  ///< Smaller than its own index.
  Pose world_from_rest;
};

/// Builds a clip from world poses.
///
/// In the rest pose the axes of all joints are aligned with the world, regardless of their axes in
/// the file: with all rotations identity the skeleton is in the rest pose. Bone lengths are those
/// of the motion, not of the rest pose. A joint whose translation is the same in all frames has it
/// as its offset. A joint that translates has its offset in the rest pose, at the scale of the
/// motion, unless the rest pose has another length there; then it has the offset of the first
/// frame.
class ClipBuilder {
 public:
  /// Bytes per frame of `joints` joints while a clip is built.
  [[nodiscard]] static std::size_t frame_bytes(std::size_t joints);

  ClipBuilder(std::vector<WorldJoint> joints, FrameRate rate, int frame_count);

  void set_frame(int frame, std::span<const Pose> world_from_joint);

  [[nodiscard]] Clip build() const;

 private:
  // Whether a joint translates relative to its parent by more than rounding.
  [[nodiscard]] bool is_translated(std::size_t joint, double tolerance) const;
  [[nodiscard]] double size() const;
  // Offset from the parent in the rest pose.
  [[nodiscard]] Eigen::Vector3d rest_offset(std::size_t joint) const;
  // Median ratio of the bones' lengths in the first frame to those in the rest pose.
  [[nodiscard]] double motion_per_rest() const;
  // Offset of a joint that translates. @param scale  see motion_per_rest
  [[nodiscard]] Eigen::Vector3d zero_offset(std::size_t joint, double scale) const;

  std::vector<WorldJoint> joints_;
  FrameRate rate_;
  int frame_count_;
  std::vector<Eigen::Quaterniond> rotations_;  // Frame-major, parent_from_joint.
  std::vector<Eigen::Vector3d> translations_;  // Frame-major.
};

}  // namespace retarget
