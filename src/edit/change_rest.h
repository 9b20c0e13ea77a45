#pragma once

#include <memory>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// A clip on another skeleton, and how well it fits.
struct RestChange {
  Clip clip;
  /// Largest distance, over joints, end sites and frames, between where they are and where they
  /// were; file units. 0 but for rounding where bone lengths agree and the bones that leave one
  /// joint form the same angles in both skeletons.
  double largest_distance = 0.0;
};

/// The same movement on a skeleton with other rest directions (A-pose to T-pose), joint order or
/// channels. Joints are matched by name and must form the same tree.
///
/// With R the local rotations and Q_i the rotation that takes the rest directions of what leaves
/// joint i (children and end sites) from the source to the target,
///     R_target,i = Q_parent(i) R_source,i Q_i^-1,
/// Q being the identity above the root and for joints that nothing leaves. Then the world rotation
/// of joint i is that of the source times Q_i^-1, and what leaves it points as before. Q_i is the
/// least rotation for one direction, the best by least squares (Kabsch) for several.
/// A translation of its own keeps its world value; bone lengths are the target's.
///
/// @param file  of the clip, and of the target, for messages.
/// @return kInput errors: names that are missing, doubled, or below another parent.
[[nodiscard]] Result<RestChange> change_rest(const Clip& clip,
                                             const std::shared_ptr<const Skeleton>& target,
                                             const std::string& file,
                                             const std::string& target_file);

}  // namespace retarget
