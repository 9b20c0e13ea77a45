#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "human/skeleton/posed_body.h"
#include "human/skeleton/rest_pose.h"
#include "human/skeleton/up_axis.h"
#include "retarget/options.h"

namespace retarget {

/// Compares an up axis that the user states with the choice that retarget makes without it. Returns
/// a human-readable warning if they differ by more than 60 degrees and the choice is certain: it
/// has no doubt, or the body clearly stands along the chosen axis only. Empty: no warning. The
/// stated axis applies in any case; the choice may be wrong for bodies that lie.
[[nodiscard]] std::string doubt_stated_up(const Body& body, const std::vector<JointPoses>& poses,
                                          const Eigen::Vector3d& stated, const UpChoice& found);

/// Compares a stated facing of a rest pose with that of its hips and shoulders; as doubt_stated_up.
[[nodiscard]] std::string doubt_stated_forward(const Body& body, const RestCandidate& rest,
                                               const SignedAxis& stated);

}  // namespace retarget
