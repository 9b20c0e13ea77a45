#pragma once

#include <optional>
#include <string>
#include <vector>

#include "human/skeleton/calibrate.h"
#include "human/skeleton/posed_body.h"
#include "retarget/options.h"

namespace retarget {

/// Evidence for a file's up axis other than the motion.
struct KnownUp {
  std::optional<SignedAxis> of_kind = {};       ///< Up axis of all skeletons of this kind.
  std::optional<SignedAxis> of_zero_pose = {};  ///< Up axis of a well-formed zero pose.
  std::optional<SignedAxis> of_file = {};       ///< Stated by the file.
  std::optional<SignedAxis> of_fall = {};       ///< Opposite to the body's fall: free_fall_axis.
};

struct UpChoice {
  SignedAxis axis;
  std::string doubt;  ///< Human-readable reason why it may be wrong; empty: no doubt.
};

/// Chooses the up axis of a file. Priority: the file's own statement, the kind of skeleton, the
/// zero pose, then posture. Posture alone overrides none of the others, since people lie, swim and
/// do handstands. To overrule, the body must also stand on a floor (clearly_stands), the lowest
/// joint must climb along the known axis, or the body must fall along the guessed one. The choice
/// has a warning if evidence disagrees. Without other knowledge the motion decides, by the
/// directions of trunk and legs and the range of the lowest joint, and by a fall, which does not turn
/// over a body that stands; without poses the result is y, by convention.
[[nodiscard]] UpChoice choose_up(const Body& body, const std::vector<JointPoses>& poses,
                                 const KnownUp& known);

}  // namespace retarget
