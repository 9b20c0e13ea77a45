#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/plan/motion_target.h"
#include "app/run/csv_sink.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/run.h"

namespace retarget {

/// A motion to write.
struct OutputMotion {
  const RobotClip* clip = nullptr;       ///< Must outlive the writing.
  std::optional<HumanInWorld> human;     ///< The source motion, for formats that show it.
  std::optional<FootContacts> contacts;  ///< Empty if unknown.
};

/// Formats the sidecar of a file.
using SidecarText = std::function<Result<std::string>(const WrittenFile&)>;

/// All files of one motion. They appear together after everything was formatted and written, or not
/// at all. Only an error during the final renames can leave some of them.
class MotionOutputs {
 public:
  /// Opens the outputs of a motion.
  /// @param rate       frame rate of the motion.
  /// @param in_memory  computes hashes only and writes nothing.
  [[nodiscard]] static Result<std::unique_ptr<MotionOutputs>> open(
      const std::string& output, const SaveOptions& options,
      const std::shared_ptr<const Robot>& robot, const FrameRate& rate, bool in_memory = false);

  /// Adds the next frame: CSVs are written while frames are solved.
  void add(std::span<const double> qpos);

  /// Formats everything except CSVs, writes all files and moves them to their final paths.
  /// @param motions   first the frames given to add(); then the same motion at other rates, for
  ///                  formats that need them. A format whose rate is missing is made from the
  ///                  first.
  /// @param sidecar   formats `<output>.json` for each file; null: none.
  /// @param left_out  receives the errors of formats that cannot represent these motions (for
  ///                  example because they are too short), if another format can be written; null:
  ///                  such a format is an error.
  [[nodiscard]] Result<std::vector<WrittenFile>> finish(std::span<const OutputMotion> motions,
                                                        const SidecarText& sidecar = {},
                                                        std::vector<Error>* left_out = nullptr);

 private:
  MotionOutputs() = default;
  Result<void> write_others(std::span<const OutputMotion> motions, std::vector<Error>* left_out);
  Result<void> commit();

  SaveOptions options_;
  WriteMotionOptions write_options_;
  bool in_memory_ = false;
  std::vector<OutputItem> items_;
  std::vector<std::unique_ptr<CsvSink>> sinks_;      // By item; null: not a CSV.
  std::vector<std::optional<MotionTarget>> others_;  // By item; nothing: a CSV.
  std::vector<OutputFile> sidecars_;                 // Includes the contacts file.
  std::vector<WrittenFile> written_;
};

/// Hash of a motion's files: of the single file, or of names and hashes of the files in a folder,
/// as in folder_hash.
[[nodiscard]] Result<std::string> hash_files(const std::vector<FormattedFile>& files);

/// Index of the motion from which a file of this format is made: the one at its rate, otherwise the
/// first.
[[nodiscard]] std::size_t motion_of_format(MotionFormat format, const SaveOptions& options,
                                           std::span<const OutputMotion> motions);

/// Warns about motion data that the output formats cannot store.
void warn_of_losses(const RobotClip& motion, std::span<const WrittenFile> files,
                    Observer& observer);

/// File names such as `walk.csv`, or `standard output`, separated by commas.
[[nodiscard]] std::string outputs_text(std::span<const WrittenFile> files);

}  // namespace retarget
