#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace retarget {

/// An order in which programs write the places of joints.
struct JointOrder {
  std::string_view name;    ///< For messages: `SMPL-X`.
  std::string_view joints;  ///< Names, blanks between them; `*` stands for a hand's
                            ///< fingers, `+` for SOMA's.
  std::size_t unread = 0;   ///< So many joints follow that are not read.

  /// Names of the joints that are read, by which recognition knows them.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Of all joints.
  [[nodiscard]] std::size_t joint_count() const { return names().size() + unread; }
};

/// The orders in which places of joints come without names. Several have the same number of joints;
/// which of them it is the places tell.
[[nodiscard]] std::span<const JointOrder> joint_orders();

/// The orders of Kimodo's files, whose joints have rotations as well; each has another number.
[[nodiscard]] std::span<const JointOrder> kimodo_orders();

}  // namespace retarget
