#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "human/human_clip.h"
#include "ik/ik_solver.h"
#include "pipeline/targets.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// How a human clip becomes a robot clip.
struct SolveFramesOptions {
  IkEngine engine = IkEngine::kFast;
  ScaleRule scale = ScaleRule::kTable;
  TrunkRule trunk = TrunkRule::kBones;
  IkOptions ik;
  /// Begin with the root on its target and solve the first frame until it settles, so that nothing
  /// of the way there is left in the motion, and again every frame into which the root's target
  /// turns by more than 60 degrees. An upper arm that is more than 60 degrees off is looked for another
  /// way, which then counts from where both ways meet, two seconds back at most. The published method
  /// solves each frame once, the first from the model's zero configuration.
  bool settle = false;
  /// Make the targets ahead of the solver on a second thread; the result is the same.
  bool targets_ahead = false;
  /// Asked before every frame with its number; false stops the run with ErrorKind::kInterrupted.
  std::function<bool(int frame)> keep_going;
  /// Told every frame's configuration, in order, as soon as it does not change any more, on the
  /// caller's thread.
  std::function<void(int frame, std::span<const double> qpos)> frame_solved;
};

/// A robot clip and what it took to solve it.
struct SolvedFrames {
  RobotClip clip;
  long steps = 0;           ///< IK steps of all frames and passes.
  int max_steps = 0;        ///< Of a single frame.
  double mean_error = 0.0;  ///< Mean over frames of the last pass's final unweighted error norm.
};

/// Retargets frame by frame with the published two-pass method: the first frame starts from the
/// model's zero configuration (qpos0), every other from the frame before.
///
/// Errors: weights that lead to values that are not finite (kConfig); a mapped bone that the clip
/// lacks, or positions too large to compute with (kInput; without a file where the clip is not given).
[[nodiscard]] Result<SolvedFrames> solve_frames(const HumanClip& human,
                                                const std::shared_ptr<const Robot>& robot,
                                                const ResolvedConfig& config,
                                                const LimitSet& limits,
                                                const SolveFramesOptions& options = {});

/// The same for a clip under a retargeting configuration, without holding all human poses in memory.
[[nodiscard]] Result<SolvedFrames> solve_frames(const Clip& clip, const Calibration& calibration,
                                                const std::shared_ptr<const Robot>& robot,
                                                const ResolvedConfig& config,
                                                const LimitSet& limits,
                                                const SolveFramesOptions& options = {});

/// Targets of all frames.
struct MadeTargets {
  const TargetBuilder& targets;  ///< That they were made with.
  FrameRate rate;
  std::vector<Pose> world_from_target;  ///< Frame-major.
};

/// The same for targets that were made before; what options say of how to make them does not count.
[[nodiscard]] Result<SolvedFrames> solve_frames(const MadeTargets& made,
                                                const std::shared_ptr<const Robot>& robot,
                                                const ResolvedConfig& config,
                                                const LimitSet& limits,
                                                const SolveFramesOptions& options = {});

}  // namespace retarget
