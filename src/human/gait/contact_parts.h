#pragma once

#include <cstddef>
#include <string_view>

namespace retarget {

/// A part of a human whose contacts can be edited.
struct ContactPart {
  std::string_view name;
  int foot = -1;            ///< 0 left, 1 right; -1: another part.
  int end = -1;             ///< kHeelEnd, kToeEnd; -1: both.
  std::size_t support = 0;  ///< For parts that are not feet: index into kSupportBones.
};

/// Returns null for an unknown name.
[[nodiscard]] const ContactPart* find_contact_part(std::string_view name);

}  // namespace retarget
