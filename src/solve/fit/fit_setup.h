#pragma once

#include "human/skeleton/human_clip.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "solve/fit/fit_model.h"
#include "solve/targets/targets.h"

namespace retarget {

/// Preparation shared by fits of whole clips and of streams (src/live).

/// Scales of the root's and the feet's paths, measured from the response of the targets to raised
/// bones.
struct PathScales {
  double root = 1.0, foot = 1.0;
};
[[nodiscard]] PathScales path_scales(const TargetBuilder& targets);

/// The limits of the first stage. If the robot has a narrower limit set for the published method,
/// that set applies: with fewer ways to bend, the frame-by-frame solver stays on the human-like
/// branch.
[[nodiscard]] LimitSet first_limits(const Robot& robot, const LimitSet& limits);

/// Adapts the weights to the leg length (hip to knee to ankle, metres). Weights per metre are tuned
/// for the G1. A robot half as large moves its limbs half as far for the same angles, so its
/// weights double. The weights of contacts, floor and overlaps never decrease, because those errors
/// matter in metres.
[[nodiscard]] FitOptions sized_options(FitOptions options, double leg);

/// The options for a robot. A fixed base disables all floor and foot terms, and dynamics.
[[nodiscard]] FitOptions options_for(const Robot& robot, FitOptions options);

/// The sides on which the source has the bones that contact detection needs.
[[nodiscard]] SourceSides sides_with_feet(const HumanClipInfo& info);

/// The source foot that a robot foot follows: 0 left, 1 right.
[[nodiscard]] inline int source_foot(const FitFoot& foot) {
  return foot.left ? 0 : 1;
}

}  // namespace retarget
