#pragma once

#include <optional>
#include <string>
#include <vector>

#include "human/human_clip.h"
#include "pipeline/targets.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// What pushes a joint against its limit: the position or the rotation of one task.
struct LimitPush {
  int body = 0;             ///< The task's body, an index into Robot::bodies().
  Bone bone = Bone::kHips;  ///< The bone it follows.
  bool rotation = false;    ///< The task's rotation; else its position.
  double strength = 0.0;    ///< Half the part's squared weighted error falls by so much per rad (m)
                            ///< beyond the limit; mean over the frames at the limit, above 0.
  double shortfall = 0.0;   ///< The part's error without weight, rad or m; mean over those frames.
};

/// A joint that is at one of its limits in many frames, and why.
struct JointAtLimit {
  int joint = 0;  ///< Index into Robot::joints().
  bool at_upper = false;
  int frames = 0;                 ///< Frames within kDiagnosedAtLimit of that limit, or beyond it.
  double share = 0.0;             ///< Of the clip's frames.
  std::optional<LimitPush> push;  ///< The strongest push; nothing: no task pushes that way.
  std::string wider_set;          ///< The robot's limit set that is widest at that side; may be
                                  ///< empty: none is wider than the one in use.
  double wider_by = 0.0;          ///< By so much, rad or m; +infinity: it has no limit there.
};

/// A joint this near to a limit (rad or m) was stopped by it.
inline constexpr double kDiagnosedAtLimit = 1e-6;

/// The joints at a limit in at least `min_share` of the frames, most frames first, each with the
/// task that pushes most against that limit, of the configuration's last pass or, where that moves the
/// joint not at all, of the one before. Joints that no task moves and joints whose range is one
/// value, which are held, are left out.
///
/// A push is the derivative of a task's part of the objective,
///   1/2 w_p^2 |e_v|^2 or 1/2 w_r^2 |w|^2 with e = log(T_body^-1 T_target) = [e_v; w],
/// along the joint, summed over the frames at that limit.
/// @param targets  made from these tables.
/// @param poses    called for frames at a limit alone, in ascending order.
/// @param limits   the ones that the clip was solved under.
[[nodiscard]] std::vector<JointAtLimit> joints_at_limits(const RobotClip& clip,
                                                         const ResolvedConfig& config,
                                                         const TargetBuilder& targets,
                                                         const HumanPoseSource& poses,
                                                         const LimitSet& limits, double min_share);

/// The same for a clip that was solved from a clip under a retargeting configuration.
[[nodiscard]] std::vector<JointAtLimit> joints_at_limits(const RobotClip& robot_clip,
                                                         const Clip& clip,
                                                         const Calibration& calibration,
                                                         const ResolvedConfig& config,
                                                         ScaleRule scale, TrunkRule trunk,
                                                         const LimitSet& limits, double min_share);

}  // namespace retarget
