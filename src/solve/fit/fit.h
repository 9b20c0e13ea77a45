#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "human/gait/contact_plan.h"
#include "human/skeleton/human_clip.h"
#include "retarget/clip.h"
#include "retarget/contact_edits.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "retarget/solved_scene.h"
#include "scene/scene_world.h"
#include "solve/targets/solve_frames.h"

namespace retarget {

/// A fitted motion and its report.
struct FitResult {
  RobotClip clip;
  FitReport report;
  ContactPlan contacts;              ///< Of the source.
  long steps = 0;                    ///< IK steps of the first stage.
  std::optional<SolvedScene> scene;  ///< Set if the fit had a scene.
};

/// Run parameters of a fit.
struct FitRun {
  SolveFramesOptions
      retarget;  ///< Options of the first stage; the fit replaces settle and frame_solved.
  /// Called periodically with the share of the work done, possibly from another thread. Returning
  /// false stops the run with ErrorKind::kInterrupted.
  std::function<bool(double done)> keep_going;
  /// Configuration of the joints that follow no target, such as fingers. The fit holds them there,
  /// so that self-collision sees them where they will be. Empty: the robot's zero configuration.
  std::vector<double> held;
  /// Whether limbs on the wrong branch are moved to another one.
  bool recover_limbs = true;
  /// The scene around the human in the frames of the clip; null: only the floor. Without feet in
  /// the source or the robot it is ignored.
  const SceneWorld* scene = nullptr;
  ObjectMotion object_motion = ObjectMotion::kGiven;
  /// Whether joints keep their speed limits, FitOptions::max_joint_speed and ::max_joint_step. False
  /// shows how fast the human's movement would be.
  bool limit_speeds = true;
  /// Changes to the contacts that are found in the source.
  std::span<const ContactEdit> contact_edits = {};
};

/// Retargets a whole clip (docs/fit.md):
///
/// 0. Finds the floor height of the source and the contacts of heels and toes, and shifts the
///    targets so that planted soles lie on the floor.
/// 1. Runs the two-pass method, starting from a settled first frame.
/// 2. Takes damped Gauss-Newton steps over all frames: tracking, smoothness, planted feet that do
///    not slide, nothing below the floor, no self-collision.
/// 3. Brings the result inside the limits.
///
/// For the values rounded to FitOptions::decimals digits, the result is always finite, its
/// quaternions are unit and sign-continuous, all joints are inside `limits`, and no joint exceeds
/// its speed limit, FitOptions::max_joint_speed or FitOptions::max_joint_step. The report lists
/// where step 3 changed the motion. A robot without soles or collision shapes is solved without
/// those terms.
///
/// Errors: as solve_frames().
[[nodiscard]] Result<FitResult> fit(const Clip& clip, const Calibration& calibration,
                                    const std::shared_ptr<const Robot>& robot,
                                    const ResolvedConfig& config, const LimitSet& limits,
                                    const FitOptions& options = {}, const FitRun& run = {});

}  // namespace retarget
