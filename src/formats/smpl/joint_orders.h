#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/smpl/joint_motion.h"

namespace retarget {

/// A joint order in which some program writes joint positions.
struct JointOrder {
  std::string_view name;    ///< For messages: `SMPL-X`.
  std::string_view joints;  ///< Names separated by spaces; `*` stands for the fingers of a hand,
                            ///< `+` for SOMA's fingers.
  std::size_t unread = 0;   ///< Number of further joints, which are not read.

  /// Names of the joints that are read, spelled so that skeleton recognition knows them.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Number of all joints in the file.
  [[nodiscard]] std::size_t joint_count() const { return names().size() + unread; }
};

/// Known orders of joint positions without names. Several orders have the same number of joints;
/// the positions decide between them.
[[nodiscard]] std::span<const JointOrder> joint_orders();

/// Orders of Kimodo's files, which also have joint rotations. Their joint counts are distinct.
[[nodiscard]] std::span<const JointOrder> kimodo_orders();

/// Bridges the frames in which a joint is lost, by a straight line between those in which it is known: no
/// coordinate of it is a number, or it is exactly at the origin, far from where it is before and after.
/// 30 frames at most; at the start and end nothing is bridged. Warnings say which joints, and how often.
void bridge_lost_points(JointMotion& motion);

}  // namespace retarget
