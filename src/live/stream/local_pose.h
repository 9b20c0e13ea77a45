#pragma once

#include <cstddef>
#include <span>

#include "retarget/pose.h"

namespace retarget {

/// A joint's pose relative to its parent, from world poses.
/// @param parent  index into world_from_joint; -1: no parent.
[[nodiscard]] inline Pose parent_from_joint(std::span<const Pose> world_from_joint, int parent,
                                            const Pose& world_from_this) {
  if (parent < 0) return world_from_this;
  return world_from_joint[static_cast<std::size_t>(parent)].inverse() * world_from_this;
}

}  // namespace retarget
