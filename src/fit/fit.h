#pragma once

#include <functional>
#include <memory>
#include <string>

#include "human/contact_plan.h"
#include "human/human_clip.h"
#include "pipeline/solve_frames.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// A motion and what it took.
struct FitResult {
  RobotClip clip;
  FitReport report;
  ContactPlan contacts;  ///< Of the source.
  long steps = 0;        ///< IK steps of the first stage.
};

/// How a fit runs.
struct FitRun {
  SolveFramesOptions
      retarget;  ///< Of the first stage; its frame_solved is not told the end result.
  /// Asked now and then with the share of the work that is done, perhaps from another thread; false
  /// stops the run with ErrorKind::kInterrupted.
  std::function<bool(double done)> keep_going;
  /// Configuration in which joints that follow nothing are held, such as fingers, so that they are kept out
  /// of other parts as they will be; empty: the robot's zero configuration.
  std::vector<double> held;
  /// Limbs that hang on the wrong branch are taken to another one.
  bool recover_limbs = true;
};

/// Retargets a clip as a whole (docs/fit.md):
///
/// 0. the height of the source's floor and the times in which heels and toes are in contact;
///    targets are moved so that planted soles lie on the floor;
/// 1. the two-pass method, from a settled first frame;
/// 2. damped Gauss-Newton steps over all frames: tracking, smoothness, planted feet that do not
///    slide, nothing below the floor, no self-collision;
/// 3. the result is brought inside the limits.
///
/// For the numbers as printed with FitOptions::decimals digits the result is always finite, with
/// sign-continuous unit quaternions, all joints inside `limits`, and no joint faster than its speed
/// limit, FitOptions::max_joint_speed or FitOptions::max_joint_step allow. Where that changed the motion
/// the report says so. A robot without soles or collision shapes goes without those terms.
///
/// Errors: as solve_frames().
[[nodiscard]] Result<FitResult> fit(const Clip& clip, const Calibration& calibration,
                                    const std::shared_ptr<const Robot>& robot,
                                    const ResolvedConfig& config, const LimitSet& limits,
                                    const FitOptions& options = {}, const FitRun& run = {});

}  // namespace retarget
