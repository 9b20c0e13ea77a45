#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_poser.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "solve/ik/ik_solver.h"
#include "solve/targets/targets.h"

namespace retarget {

/// Provides the targets of a clip's frames in order.
///
/// A second thread may build targets ahead of the solver, at most a few hundred frames, so that
/// memory does not grow with the clip. The targets do not depend on the thread that builds them.
class TargetStream {
 public:
  /// @param targets  must outlive the stream.
  /// @param ahead    whether to build on a separate thread. Without an available thread, next()
  ///     builds the targets.
  TargetStream(int frame_count, HumanPoseSource human, const TargetBuilder& targets, bool ahead);
  ~TargetStream();
  TargetStream(const TargetStream&) = delete;
  TargetStream& operator=(const TargetStream&) = delete;

  /// Targets of the next frame, valid until the next call.
  /// @pre fewer than frame_count previous calls.
  [[nodiscard]] std::span<const Pose> next();

 private:
  static constexpr int kChunkFrames = 32;
  static constexpr int kChunks = 8;

  void make_chunks();
  void make_frames(int begin, int end);
  std::span<Pose> slot_of(int frame);

  const int frame_count_;
  const HumanPoseSource human_;
  const TargetBuilder& targets_;
  HumanPose world_from_bone_;
  std::vector<Pose> ring_;  // Ring buffer of frames, indexed by frame number modulo its length.
  int frame_ = 0;           // Frame of the next call of next().

  std::thread maker_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int made_ = 0;      // Frames below this number are in the ring buffer.
  int released_ = 0;  // Frames below this number may be overwritten.
  bool stop_ = false;
};

/// Options for solving a human clip frame by frame.
struct SolveFramesOptions {
  IkEngine engine = IkEngine::kFast;
  ScaleRule scale = ScaleRule::kTable;
  TrunkRule trunk = TrunkRule::kBones;
  IkOptions ik;
  /// Whether to set the root to its target and to solve the first frame repeatedly until it
  /// converges, so that the motion does not contain the approach. The same happens in frames in
  /// which the root's target rotates by more than 60 degrees at more than 20 rad/s. If an upper arm
  /// has a rotation error of more than 60 degrees, also searches for another configuration. A
  /// better one replaces the solved frames back to the frame in which both branches meet, at most
  /// two seconds. Without this option, each frame is solved once and the first starts from the
  /// model's zero configuration, as in the published method.
  bool settle = false;
  /// Whether to build the targets ahead of the solver on a second thread. The result is the same.
  bool targets_ahead = false;
  /// Called before every frame with its number. Returning false stops the run with
  /// ErrorKind::kInterrupted.
  std::function<bool(int frame)> keep_going;
  /// Receives the configuration of every frame in order, as soon as it is final, on the caller's
  /// thread.
  std::function<void(int frame, std::span<const double> qpos)> frame_solved;
};

/// A solved robot clip with statistics.
struct SolvedFrames {
  RobotClip clip;
  long steps = 0;           ///< IK steps of all frames and passes.
  int max_steps = 0;        ///< Largest number of IK steps for a single frame.
  double mean_error = 0.0;  ///< Mean over frames of the last pass's final unweighted error norm.
};

/// Retargets frame by frame with the published two-pass method: the first frame starts from the
/// model's zero configuration (qpos0), every other frame from the previous one.
///
/// Errors: weights that lead to non-finite values (kConfig); a mapped bone that the clip lacks, or
/// targets that are not finite or too large (kInput; without a file name if no Clip is given);
/// `keep_going` returned false (kInterrupted).
[[nodiscard]] Result<SolvedFrames> solve_frames(const HumanClip& human,
                                                const std::shared_ptr<const Robot>& robot,
                                                const ResolvedConfig& config,
                                                const LimitSet& limits,
                                                const SolveFramesOptions& options = {});

/// Solves a clip with its calibration, without keeping all human poses in memory.
[[nodiscard]] Result<SolvedFrames> solve_frames(const Clip& clip, const Calibration& calibration,
                                                const std::shared_ptr<const Robot>& robot,
                                                const ResolvedConfig& config,
                                                const LimitSet& limits,
                                                const SolveFramesOptions& options = {});

/// The targets of all frames.
struct MadeTargets {
  const TargetBuilder& targets;  ///< The builder that made them.
  FrameRate rate;
  std::vector<Pose> world_from_target;  ///< Frame-major.
};

/// Solves existing targets. Ignores the options `scale`, `trunk` and `targets_ahead`.
[[nodiscard]] Result<SolvedFrames> solve_frames(const MadeTargets& made,
                                                const std::shared_ptr<const Robot>& robot,
                                                const ResolvedConfig& config,
                                                const LimitSet& limits,
                                                const SolveFramesOptions& options = {});

}  // namespace retarget
