#pragma once

#include <string>
#include <variant>
#include <vector>

#include "base/output_folder.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/normalize_start.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/run.h"
#include "retarget/solve.h"

namespace retarget {

/// Output of a motion in one format: a file or folder, written completely or not at all.
class MotionTarget {
 public:
  [[nodiscard]] static Result<MotionTarget> create(const OutputItem& item);

  [[nodiscard]] Result<void> write(const std::vector<FormattedFile>& files);
  [[nodiscard]] Result<void> commit();

 private:
  explicit MotionTarget(OutputFile file) : place_(std::move(file)) {}
  explicit MotionTarget(OutputFolder folder) : place_(std::move(folder)) {}
  std::variant<OutputFile, OutputFolder> place_;
};

/// Transform of a solved motion for SaveOptions::normalize_start.
[[nodiscard]] StartNormalizer start_of(const Motion& motion);

/// Moves a motion before writing; the human shown with it and its scene move along.
void normalize_start(const StartNormalizer& start, RobotClip& clip, WriteMotionOptions& write);

/// Name of a motion, which is that of its file without the extension: `walk.v2` for
/// walk.v2.motion-lib.pkl.
[[nodiscard]] std::string name_of_motion(const std::string& output);

/// Layouts of the single CSVs (csv, csv-soma) that options write, the coarsest first; empty: none.
/// @param rate  frame rate of the motion.
[[nodiscard]] std::vector<RobotCsvOptions> csv_layouts(const SaveOptions& options,
                                                       const FrameRate& rate);

/// Name of the requested reference file next to an output; empty: none.
/// Errors (kUsage): an extension other than .npz and .csv; no name if the motion goes to standard
/// output.
[[nodiscard]] Result<std::string> reference_path(const std::string& output,
                                                 const SaveOptions& options);

/// Files next to a motion that are written but not committed yet.
struct FilesBeside {
  std::vector<OutputFile> files;
  /// Summary of the reference: samples, corrections, and limits that it still exceeds.
  std::vector<SummaryLine> lines;
};

/// Writes the files that options request next to a motion: its contacts as CSV, its scene, and its
/// reference (make_reference). Errors: those of format_scene and make_reference; the motion has no
/// contacts or no scene (kUsage).
/// @param reference  result of reference_path().
/// @param clip       the motion as it is written to its file.
/// @param write      contacts and scene of the motion.
/// @param limits     joint ranges; null: the robot's default set.
[[nodiscard]] Result<FilesBeside> write_files_beside(const std::string& reference,
                                                     const RobotClip& clip,
                                                     const WriteMotionOptions& write,
                                                     const SaveOptions& options,
                                                     const LimitSet* limits);

}  // namespace retarget
