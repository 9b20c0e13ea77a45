#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/human_poser.h"
#include "retarget/motion.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "solve/targets/targets.h"

namespace retarget {

/// A residual that pushes a joint against its limit: position or rotation of one task.
struct LimitPush {
  int body = 0;             ///< Body of the task, an index into Robot::bodies().
  Bone bone = Bone::kHips;  ///< Bone that the body follows.
  bool rotation = false;    ///< True for the task's rotation; false for its position.
  double strength = 0.0;    ///< Reduction of half the squared weighted error per rad (m) beyond the
                            ///< limit; mean over the frames at the limit, > 0.
  double shortfall = 0.0;   ///< Unweighted error, rad or m; mean over those frames.
};

/// A joint that is at one of its limits in many frames, with the cause.
struct JointAtLimit {
  int joint = 0;          ///< Index into Robot::joints().
  bool at_upper = false;  ///< Whether it is at its upper limit.
  int frames = 0;         ///< Number of frames within kDiagnosedAtLimit of the limit or
                          ///< beyond it.
  double share = 0.0;     ///< Share of these frames in the clip.
  std::optional<LimitPush>
      push;               ///< The strongest push; empty if no task pushes towards the limit.
  std::string wider_set;  ///< Name of the robot's limit set that is widest at this limit;
                          ///< empty if none is wider than the one in use.
  double wider_by = 0.0;  ///< Additional range of that set, rad or m; +infinity if
                          ///< unlimited.
};

/// Largest distance from a limit at which a joint is at the limit, rad or m.
inline constexpr double kDiagnosedAtLimit = 1e-6;

/// Finds the joints that are at a limit in at least `min_share` of the frames, most frames first,
/// and for each joint the task that pushes it most strongly against the limit. The tasks are those
/// of the last pass that moves the joint. Excludes joints that no task moves, and locked joints,
/// whose range is a single value.
///
/// A push is the derivative of a task's part of the objective,
///   1/2 w_p^2 |e_v|^2 or 1/2 w_r^2 |w|^2 with e = log(T_body^-1 T_target) = [e_v; w],
/// along the joint, averaged over the frames at the limit.
/// @param targets  builder made from `config`.
/// @param poses    called in ascending order for frames with a joint at a limit.
/// @param limits   limits with which the clip was solved.
[[nodiscard]] std::vector<JointAtLimit> joints_at_limits(const RobotClip& clip,
                                                         const ResolvedConfig& config,
                                                         const TargetBuilder& targets,
                                                         const HumanPoseSource& poses,
                                                         const LimitSet& limits, double min_share);

}  // namespace retarget
