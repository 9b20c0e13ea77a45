#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/normalize_start.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/solved_scene.h"

namespace RETARGET_API retarget {

/// Stage of solve().
enum class Stage : unsigned char {
  kFrames,  ///< Inverse kinematics, frame by frame.
  kFit,     ///< Whole-clip fit; done / total is the fraction of the work done.
};
/// Progress of solve().
struct Progress {
  Stage stage = Stage::kFrames;
  int done = 0, total = 0;
};

/// Callbacks, threads and the extent of the report of solve(); they do not affect the motion.
struct SolveControl {
  /// Called periodically with the progress, possibly from another thread. Returning false stops the
  /// run with ErrorKind::kInterrupted.
  std::function<bool(const Progress&)> keep_going;
  /// Called with the final configuration of every frame (layout of RobotClip), in order, on the
  /// caller's thread.
  std::function<void(int frame, std::span<const double> qpos)> frame_solved;
  int threads = 0;  ///< Number of threads; 0: automatic.
  /// Whether to measure the costs of a fit's terms, which takes 7 % of its time.
  bool fit_costs = true;
};

/// A robot's motion and its provenance.
struct Motion {
  RobotClip clip;
  std::shared_ptr<const Clip> source;  ///< The human clip, cut and resampled: one frame per
                                       ///< frame of the motion.
  Plan plan;                           ///< The solved plan, without its clip.
  long ik_steps = 0;                   ///< Inverse kinematics steps, all frames.
  std::optional<FitReport> fit;        ///< Method::kFit only: results of the fit.
  std::optional<SolvedScene> scene;  ///< Method::kFit only: the robot's scene, if the plan has one.
  SourceContacts contacts;  ///< Method::kFit only: the source's foot contacts that the fit used.
  /// Failures of all solvers; a motion with a failure misses a gate.
  std::vector<SolverFailure> solver_failures;
  /// Transform of SaveOptions::normalize_start; empty: that of the clip's own first frame. Solutions
  /// of one run at several rates share the transform of the first, so that their files have one
  /// world.
  std::optional<StartNormalizer> start;
};

/// Finds Plan::time_scale for SolveOptions::time_scale `auto` (docs/references.md): solves the
/// motion without speed limits, slows it down where it exceeds them, and repeats this until it does
/// not. Returns other plans, and plans with a known time scale, unchanged. A motion within its
/// limits gets no time scale.
/// Errors: those of solve().
[[nodiscard]] Result<Plan> decide_time_scale(Plan plan, const SolveControl& control = {});

/// Cuts a plan's clip to the plan's part, resamples it to the motion's rate and applies the plan's
/// time scale.
/// Errors (kInput): rates that give an implausible number of frames; a body kilometres away from
/// the origin.
[[nodiscard]] Result<std::shared_ptr<const Clip>> prepare_clip(const Plan& plan);

/// Solves a plan. If the caller moves the plan in, solve() releases its clip after resampling.
/// Errors: those of prepare_clip; a mapped bone missing in the clip (kInput); weights that produce
/// non-finite values (kConfig); a stop by SolveControl::keep_going (kInterrupted).
[[nodiscard]] Result<Motion> solve(Plan plan, const SolveControl& control = {});

/// Returns when the ends of the robot's feet are planted. Empty: the motion was not fitted, so that
/// no term holds the feet, or the base of the robot is fixed.
[[nodiscard]] std::optional<FootContacts> contacts_of(const Motion& motion);

/// The contacts of the robot's bodies with surfaces: feet and, in a scene, knees, elbows, hands,
/// seat and back. Empty if the motion was not fitted. Without a scene, the surface under every foot
/// is the floor.
[[nodiscard]] ContactLabels contact_labels(const Motion& motion);

/// Measures a motion, with values rounded as in the output file, and checks it against the default
/// gates of the data folder (docs/quality.md).
[[nodiscard]] Result<QualityReport> evaluate(const Motion& motion);

/// Writes a motion in the format given by the options or by the file extension. Several formats go
/// to several files named after `output`. Each file is written atomically.
/// Errors: an extension that matches no format or a different one (kUsage); a write failure (kRun).
/// @param output   file name; `-` is standard output.
/// @param options  empty: the options of the motion's plan.
[[nodiscard]] Result<void> save(const Motion& motion, const std::string& output,
                                const std::optional<SaveOptions>& options = std::nullopt);
/// Writes a clip in the same way, but as a conversion: a tracking file at the clip's rate keeps all
/// frames.
[[nodiscard]] Result<void> save(const RobotClip& clip, const std::string& output,
                                const SaveOptions& options = {});

}  // namespace retarget
