#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "retarget/base/result.h"
#include "retarget/human/human_clip.h"
#include "retarget/pipeline/ik_tables.h"
#include "retarget/pipeline/retarget.h"
#include "retarget/refine/fit_options.h"
#include "retarget/robot/limits.h"
#include "retarget/robot/robot_clip.h"

namespace retarget {

/// How much a term of the fit costs, and where.
struct FitTermReport {
  std::string name;        ///< As in docs/fit.md.
  double before = 0.0;     ///< Mean over frames, of the motion that the fit starts from.
  double after = 0.0;      ///< The same at the end.
  std::vector<int> worst;  ///< Up to five frames where it is worst at the end, worst first, each
                           ///< at least half a second from the others.
};

/// A joint whose motion had to be changed at the end to keep the limits.
struct FitBoundReport {
  std::string joint;
  int frames = 0;        ///< How many frames were changed.
  int worst_frame = 0;   ///< Where it was changed most ...
  double largest = 0.0;  ///< ... and by how much, rad or m.
};

/// What a fit found and what is left.
struct FitReport {
  double floor_height = 0.0;  ///< By how much the targets were lowered, metres.
  bool floor_found = false;   ///< False: no foot of the source stands; the height is a guess.
  int contact_phases = 0;     ///< Of heels and toes.
  std::vector<FitTermReport> terms;
  std::vector<FitBoundReport> bounded;
  std::vector<std::string> notes;  ///< Terms that the robot or the source cannot have, and why.
};

/// A motion and what it took.
struct FitResult {
  RobotClip clip;
  FitReport report;
  long steps = 0;  ///< IK steps of the first stage.
};

/// How a fit runs.
struct FitRun {
  RetargetOptions retarget;  ///< Of the first stage; its frame_solved is not told the end result.
  /// Asked now and then with the share of the work that is done, perhaps from another thread; false
  /// stops the run with ErrorKind::kInterrupted.
  std::function<bool(double done)> keep_going;
};

/// Retargets a clip as a whole (docs/fit.md):
///
/// 0. the height of the source's floor and the times in which heels and toes are planted; targets
///    are moved so that planted soles lie on the floor;
/// 1. the two-pass method, from a settled first frame;
/// 2. damped Gauss-Newton steps over all frames: tracking, smoothness, planted feet that do not
///    slide, nothing below the floor, no self-collision;
/// 3. the result is brought inside the limits.
///
/// For the numbers as printed with FitOptions::decimals digits the result is always finite, with
/// sign-continuous unit quaternions, all joints inside `limits`, and no joint faster than its speed
/// limit, FitOptions::speed_most or FitOptions::largest_step allow. Where that changed the motion
/// the report says so. A robot without soles or collision shapes goes without those terms.
///
/// Errors: as retarget().
/// @param clip_name  the clip's file, for messages.
[[nodiscard]] Result<FitResult> fit(const Clip& clip, const HumanMapping& mapping,
                                    const std::string& clip_name,
                                    const std::shared_ptr<const Robot>& robot,
                                    const IkTables& tables, const LimitSet& limits,
                                    const FitOptions& options = {}, const FitRun& run = {});

}  // namespace retarget
