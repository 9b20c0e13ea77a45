#pragma once

#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "solve/fit/fit_model.h"
#include "solve/targets/targets.h"

namespace retarget {

// Preparation shared by fits of whole clips and of streams (src/solve/online).

/// Ratios of the robot's to the human's displacement, for the root and for the feet.
struct PathScales {
  double root = 1.0, foot = 1.0;
};
/// Measures how far the targets rise when the human's bones rise by one metre.
[[nodiscard]] PathScales path_scales(const TargetBuilder& targets);

/// The joint limits of the first stage: the intersection of `limits` with the robot's limit set for
/// the published method, where it is not empty. Narrower ranges keep the frame-by-frame solver on
/// the human-like branch.
[[nodiscard]] LimitSet first_limits(const Robot& robot, const LimitSet& limits);

/// Scales the weights per metre, which are tuned for a G1, to a robot's size. A robot half as large
/// moves its limbs half as far for the same angles, so its weights double. The weights of contact,
/// floor and collision terms never decrease, because the size of these errors in metres matters.
/// @param leg  length from hip to knee to ankle, metres.
[[nodiscard]] FitOptions sized_options(FitOptions options, double leg);

/// Lowers the weight of contacts of knees, elbows, hands, seat and back for a noisy source. They
/// compete with contacts of the feet, which slip more if noise moves the anchors of both
/// (docs/fit.md, "Tuning").
/// @param noise  0: none, 1: the noise of video estimates.
[[nodiscard]] FitOptions options_for_noise(FitOptions options, double noise);

/// The options without the terms that do not apply to the robot: a fixed base disables the floor
/// and foot terms and the dynamics.
[[nodiscard]] FitOptions options_for(const Robot& robot, FitOptions options);

/// The sides on which the source has the bones that contact detection needs.
[[nodiscard]] SourceSides sides_with_feet(const HumanClipInfo& info);

/// The source foot that a robot foot follows: 0 left, 1 right.
[[nodiscard]] inline int source_foot(const FitFoot& foot) {
  return foot.left ? 0 : 1;
}

}  // namespace retarget
