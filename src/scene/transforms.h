#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "scene/scene.h"

namespace retarget {

/// Where a node is: exact places, and the rotations on the way multiplied, so that scale that is not
/// even skews nothing.
struct NodePlace {
  Eigen::Affine3d world_from_node = Eigen::Affine3d::Identity();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// The place of a child by its parent's. Two axes turned over by scale are half a turn.
[[nodiscard]] NodePlace place_below(const NodePlace& parent, const NodeTransform& parent_from_node);

/// Whether scale turns space over, as a mirror does; NaN and 0 do not.
[[nodiscard]] bool is_mirrored(const NodeTransform& transform);

/// Whether all numbers are finite and the rotation is one.
[[nodiscard]] bool is_sound(const NodeTransform& transform);

/// The rotation of a matrix whose axes are about square to each other.
[[nodiscard]] Eigen::Quaterniond rotation_of(const Eigen::Matrix3d& matrix);

/// A matrix as translation, rotation and scale; a mirror's third axis has a negative scale.
[[nodiscard]] NodeTransform decomposed(const Eigen::Affine3d& affine);

/// A bind pose, if it is one: finite, of some size, no mirror.
[[nodiscard]] std::optional<Eigen::Affine3d> usable_bind(const Eigen::Affine3d& affine);

}  // namespace retarget
