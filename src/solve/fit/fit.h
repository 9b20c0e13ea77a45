#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/math/step_bounds.h"
#include "human/gait/contact_plan.h"
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
  ContactPlan contacts;              ///< Contacts of the source.
  long steps = 0;                    ///< IK steps of the first stage.
  std::optional<SolvedScene> scene;  ///< Set if the fit used a scene.
};

/// Run parameters of a fit.
struct FitRun {
  /// Options of the first stage. The fit replaces settle and frame_solved.
  SolveFramesOptions retarget;
  /// Called periodically on the calling thread with the completed share of the work, 0 to 1.
  /// Returning false stops the run with ErrorKind::kInterrupted.
  std::function<bool(double done)> keep_going;
  /// Writes the positions of joints without a target, such as fingers, into a qpos. The fit holds
  /// these joints there, so that its terms use their final positions. Empty: those of the robot's
  /// zero configuration.
  std::function<void(int frame, std::span<double> qpos)> hold;
  /// Whether to measure the costs of the terms for the report.
  bool costs = true;
  /// Whether limbs on a wrong branch of their inverse kinematics move to another branch.
  bool recover_limbs = true;
  /// The scene around the human, one pose per frame of the clip; null: only the floor. The fit
  /// ignores it if the source or the robot has no feet.
  const SceneWorld* scene = nullptr;
  ObjectMotion object_motion = ObjectMotion::kGiven;  ///< Paths of the scene's moving objects.
  /// Whether the fit enforces the joint speed limits, FitOptions::max_joint_speed and
  /// FitOptions::max_joint_step. If false, the result shows the speeds that the human's motion
  /// requires.
  bool limit_speeds = true;
  /// Units in which files print the joint positions, each with FitOptions::decimals.
  std::vector<PrintedUnits> printed = {{}};
  /// Seconds of the clip per second of the source, which was slowed down by this factor. Contacts
  /// are detected at the source's speed.
  double pace = 1.0;
  /// User edits that are applied to the contacts detected in the source.
  std::span<const ContactEdit> contact_edits = {};
};

/// Retargets a whole clip (docs/fit.md):
///
/// 0. Finds the floor height of the source and the contacts of heels and toes, and shifts the
///    targets so that planted soles lie on the floor.
/// 1. Runs the two-pass method, starting from a settled first frame.
/// 2. Takes damped Gauss-Newton steps over all frames. The cost penalises tracking errors,
///    accelerations, slip of planted feet, floor penetration and self-collision.
/// 3. Projects the joint positions onto the position and speed limits.
///
/// After rounding to FitOptions::decimals digits in each of FitRun::printed, all values are finite,
/// quaternions have unit length and continuous signs, all joints are inside `limits`, and no joint
/// exceeds its speed limit, FitOptions::max_joint_speed or FitOptions::max_joint_step. The report
/// lists the joints that step 3 changed. Without soles or collision shapes, the robot's fit omits
/// their terms.
///
/// Errors: those of solve_frames(); ErrorKind::kInput if the targets are too large or not finite;
/// ErrorKind::kConfig if the first stage yields non-finite values; ErrorKind::kInterrupted if
/// `keep_going` returned false.
[[nodiscard]] Result<FitResult> fit(const Clip& clip, const Calibration& calibration,
                                    const std::shared_ptr<const Robot>& robot,
                                    const ResolvedConfig& config, const LimitSet& limits,
                                    const FitOptions& options = {}, const FitRun& run = {});

}  // namespace retarget
