#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/report.h"

namespace RETARGET_API retarget {

/// What solve() is doing.
enum class Stage : unsigned char {
  kFrames,  ///< Inverse kinematics, frame by frame.
  kFit,     ///< All frames together; done / total is the share of work done.
};
struct Progress {
  Stage stage = Stage::kFrames;
  int done = 0, total = 0;
};

/// How a motion is solved; does not affect the result.
struct SolveControl {
  /// Called from time to time with the progress, possibly from another thread; returning false
  /// stops with ErrorKind::kInterrupted.
  std::function<bool(const Progress&)> keep_going;
  /// Called with every frame's final configuration (layout of RobotClip), in order, on the caller's
  /// thread.
  std::function<void(int frame, std::span<const double> qpos)> frame_solved;
  int threads = 0;  ///< 0: as many as useful.
};

/// A robot's motion and its provenance.
struct Motion {
  RobotClip clip;
  std::shared_ptr<const Clip> source;  ///< The human clip: cut, at the motion's rate, frame by
                                       ///< frame.
  Plan plan;                           ///< The solved plan, without its clip.
  long ik_steps = 0;                   ///< Of all frames.
  std::optional<FitReport> fit;        ///< Of Method::kFit: what it found and what is left,
  SourceContacts contacts;             ///< and when the source's feet stand, which it kept to.
};

/// The part of the clip that a plan takes, at the motion's rate.
/// Errors: rates that give an implausible number of frames; a body kilometres away (kInput).
[[nodiscard]] Result<std::shared_ptr<const Clip>> prepare_clip(const Plan& plan);

/// Solves a plan. A plan that is moved in releases its clip after resampling.
/// Errors: prepare_clip's; a mapped bone that the clip lacks (kInput); weights that lead to values that
/// are not finite (kConfig); kInterrupted.
[[nodiscard]] Result<Motion> solve(Plan plan, const SolveControl& control = {});

/// Measures a motion, rounded as it is written, and checks it against the default gates of the data
/// folder (docs/quality.md).
[[nodiscard]] Result<QualityReport> evaluate(const Motion& motion);

/// Writes a motion: in the format that the file's ending or the options name, in several formats to
/// files named after it. Each file appears whole or not at all.
/// Errors: of kUsage, an extension that gives no format or a different one; of kRun, failure to
/// write.
/// @param output  `-` writes standard output.
/// @param options  empty: those of the motion's plan.
[[nodiscard]] Result<void> save(const Motion& motion, const std::string& output,
                                const std::optional<SaveOptions>& options = std::nullopt);
[[nodiscard]] Result<void> save(const RobotClip& clip, const std::string& output,
                                const SaveOptions& options = {});

}  // namespace retarget
