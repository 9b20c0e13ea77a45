#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "human/skeleton/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
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
/// With a second thread, targets are built ahead of the solver, by a few hundred frames at most, so
/// that memory does not grow with the clip. The targets do not depend on the thread that builds
/// them.
class TargetStream {
 public:
  /// @param targets  must outlive the stream.
  /// @param ahead    build on a separate thread; if none is available, next() builds them.
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
  int frame_ = 0;           // Frame that next() returns.

  std::thread maker_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int made_ = 0;      // Frames below this number have been written to the ring buffer.
  int released_ = 0;  // Frames below this number may be overwritten.
  bool stop_ = false;
};

/// Options for solving a human clip frame by frame.
struct SolveFramesOptions {
  IkEngine engine = IkEngine::kFast;
  ScaleRule scale = ScaleRule::kTable;
  TrunkRule trunk = TrunkRule::kBones;
  IkOptions ik;
  /// Places the root on its target and repeats the first frame until it settles, so that the motion
  /// does not show the approach. Does the same in every frame in which the root's target turns by
  /// more than 60 degrees and faster than 20 rad/s. If an upper arm is more than 60 degrees off,
  /// searches for another configuration; a better one replaces the solved frames back to where both
  /// branches meet, at most two seconds. Without this option, as in the published method, each
  /// frame is solved once, the first from the model's zero configuration.
  bool settle = false;
  /// Builds the targets ahead of the solver on a second thread; the result is the same.
  bool targets_ahead = false;
  /// Called before every frame with its number; returning false stops the run with
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
/// positions too large to compute with (kInput; without a file name if no Clip is given).
[[nodiscard]] Result<SolvedFrames> solve_frames(const HumanClip& human,
                                                const std::shared_ptr<const Robot>& robot,
                                                const ResolvedConfig& config,
                                                const LimitSet& limits,
                                                const SolveFramesOptions& options = {});

/// The same for a clip and its calibration, without keeping all human poses in memory.
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

/// The same for existing targets; `options.scale`, `trunk` and `targets_ahead` are ignored.
[[nodiscard]] Result<SolvedFrames> solve_frames(const MadeTargets& made,
                                                const std::shared_ptr<const Robot>& robot,
                                                const ResolvedConfig& config,
                                                const LimitSet& limits,
                                                const SolveFramesOptions& options = {});

}  // namespace retarget
