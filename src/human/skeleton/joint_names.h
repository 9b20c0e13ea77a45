#pragma once

#include <string>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// A joint name without differences between exporters.
struct JointName {
  Side side = Side::kNone;
  std::string base;  ///< Lower case, without separators; numbers without leading zeros.

  bool operator==(const JointName&) const = default;
};

/// Normalises the joint names of one skeleton.
///
/// Removes namespaces (`mixamorig:`, `Armature|`), prefixes of well-known exporters (`Bip01`,
/// `Character1_`), and words that nearly all names begin or end with. `Left`, `L_`, `_l`, `.L`,
/// `lShldr` and similar marks become the side: `Bip01 L Thigh` is {left, "thigh"}. Centre marks
/// (`C_Head`) are removed.
[[nodiscard]] std::vector<JointName> normalise_joint_names(const std::vector<std::string>& names);

}  // namespace retarget
