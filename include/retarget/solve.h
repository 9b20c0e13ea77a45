#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"
#include "retarget/plan.h"
#include "retarget/report.h"

namespace RETARGET_API retarget {

/// What solve() is at.
enum class Stage : unsigned char {
  kFrames,  ///< Inverse kinematics, frame by frame.
  kFit,     ///< All frames together; done and total are shares of the work.
};
struct Progress {
  Stage stage = Stage::kFrames;
  int done = 0, total = 0;
};

/// How a motion is solved; nothing of it changes the result.
struct SolveControl {
  /// Told now and then how far it is, perhaps from another thread; false stops with
  /// ErrorKind::kInterrupted.
  std::function<bool(const Progress&)> keep_going;
  /// Told every frame's final configuration (layout of RobotClip), in order, on the caller's thread.
  std::function<void(int frame, std::span<const double> qpos)> frame_solved;
  int threads = 0;  ///< 0: as many as serve.
};

/// A robot's motion, and how it came about.
struct Motion {
  RobotClip clip;
  std::shared_ptr<const Clip> source;  ///< Of the human: cut, at the motion's rate; frame by frame.
  Plan plan;                           ///< That was solved; without its clip.
  long ik_steps = 0;                   ///< Of all frames.
  std::optional<FitReport> fit;        ///< Of Method::kFit: what it found and what is left,
  SourceContacts contacts;             ///< and when the source's feet stand, which it kept to.
};

/// The part of the clip that a plan takes, at the motion's rate.
/// Errors: rates that make more frames than anybody means; a body kilometres away (kInput).
[[nodiscard]] Result<std::shared_ptr<const Clip>> prepare_clip(const Plan& plan);

/// Solves a plan. A plan that is moved in frees its clip once it was resampled.
/// Errors: prepare_clip's; a mapped bone that the clip lacks (kInput); weights that lead to values that
/// are not finite (kConfig); kInterrupted.
[[nodiscard]] Result<Motion> solve(Plan plan, const SolveControl& control = {});

/// The figures of a motion as it is written with so many digits, held against the default gates of
/// the data folder (docs/quality.md).
[[nodiscard]] Result<QualityReport> evaluate(const Motion& motion);

/// Writes a motion: in the format that the file's ending or the options name, in several formats to
/// files named after it. Each file appears whole or not at all.
/// Errors: of kUsage, an ending that says no format or another one; of kRun, what cannot be written.
/// @param output  `-` writes standard output.
/// @param options  without, those that the motion's plan was made with.
[[nodiscard]] Result<void> save(const Motion& motion, const std::string& output,
                                const std::optional<SaveOptions>& options = std::nullopt);
[[nodiscard]] Result<void> save(const RobotClip& clip, const std::string& output,
                                const SaveOptions& options = {});

}  // namespace retarget
