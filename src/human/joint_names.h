#pragma once

#include <string>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// A joint's name without what differs between exporters.
struct JointName {
  Side side = Side::kNone;
  std::string base;  ///< Lower case without separators, numbers without leading zeros.

  bool operator==(const JointName&) const = default;
};

/// Normalises names that stand in one skeleton.
///
/// Dropped are namespaces (`mixamorig:`, `Armature|`), the prefixes of well-known exporters (`Bip01
/// `, `Character1_`), and words that nearly all names begin or end with. `Left`, `L_`, `_l`, `.L`,
/// `lShldr` and the like become the side: `Bip01 L Thigh` is {left, "thigh"}. Marks of the middle
/// (`C_Head`) are dropped.
[[nodiscard]] std::vector<JointName> normalise_joint_names(const std::vector<std::string>& names);

}  // namespace retarget
