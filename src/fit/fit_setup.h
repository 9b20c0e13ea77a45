#pragma once

#include "fit/fit_model.h"
#include "human/human_clip.h"
#include "pipeline/targets.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// What fits of whole clips and of streams (src/live) prepare alike.

/// Scales of the root's and the feet's paths, by what the targets do when bones are lifted.
struct PathScales {
  double root = 1.0, foot = 1.0;
};
[[nodiscard]] PathScales path_scales(const TargetBuilder& targets);

/// The limits of the first stage: where the robot has a narrower set for the published method,
/// limbs have fewer ways to bend, and the frame-by-frame solver stays on the one that people take.
[[nodiscard]] LimitSet first_limits(const Robot& robot, const LimitSet& limits);

/// Weights per metre are those of a robot with legs (hip to knee to ankle, metres) as long as the
/// G1's; of one half as large, whose limbs move half as far for the same angles, they count twice.
/// Contacts, floor and overlaps, whose amounts matter in metres, never count less.
[[nodiscard]] FitOptions sized_options(FitOptions options, double leg);

/// The options for a robot: one whose base stands fast has neither floor nor feet.
[[nodiscard]] FitOptions options_for(const Robot& robot, FitOptions options);

/// The sides on which the source has what foot contacts are found from.
[[nodiscard]] SourceSides sides_with_feet(const HumanClipInfo& info);

/// The source's foot that one of the robot's goes after.
[[nodiscard]] inline int source_foot(const FitFoot& foot) {
  return foot.left ? 0 : 1;
}

}  // namespace retarget
