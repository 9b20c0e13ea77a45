#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/file.h"
#include "plan/motion_target.h"
#include "plan/output_files.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "run/csv_sink.h"

namespace retarget {

/// A file that was made, or would have been.
struct WrittenFile {
  OutputItem item;
  std::string hash;  ///< Of its content, `sha256:...`.
};

/// A motion as it is written.
struct OutputMotion {
  const RobotClip* clip = nullptr;       ///< Must outlive the writing.
  std::optional<HumanInWorld> human;     ///< What it came from, for files that show it.
  std::optional<FootContacts> contacts;  ///< Empty: not known.
};

/// The text of the sidecar of a file.
using SidecarText = std::function<Result<std::string>(const WrittenFile&)>;

/// All files of one motion. They appear together once everything was formatted and written, or
/// not at all; only a failure while they are put in their places can part them.
class MotionOutputs {
 public:
  /// @param rate       of the motion that will come.
  /// @param in_memory  makes the hashes alone and writes nothing.
  [[nodiscard]] static Result<std::unique_ptr<MotionOutputs>> open(
      const std::string& output, const SaveOptions& options,
      const std::shared_ptr<const Robot>& robot, const FrameRate& rate, bool in_memory = false);

  /// Takes the next frame: CSVs are written while frames are solved.
  void add(std::span<const double> qpos);

  /// Formats what is no CSV, writes everything and puts it in its place.
  /// @param motions  first the frames that add() took; then the same motion at other rates, for
  ///                 formats that have them. What none has the rate of is made from the first.
  /// @param sidecar  makes `<output>.json` beside each file; null: none.
  [[nodiscard]] Result<std::vector<WrittenFile>> finish(std::span<const OutputMotion> motions,
                                                        const SidecarText& sidecar = {});

 private:
  MotionOutputs() = default;
  Result<void> write_others(std::span<const OutputMotion> motions);
  Result<void> commit();

  SaveOptions options_;
  WriteMotionOptions write_options_;
  bool in_memory_ = false;
  std::vector<OutputItem> items_;
  std::vector<std::unique_ptr<CsvSink>> sinks_;      // by item; null: no CSV
  std::vector<std::optional<MotionTarget>> others_;  // by item; nothing: a CSV
  std::vector<OutputFile> sidecars_;                 // and the contacts
  std::vector<WrittenFile> written_;
};

/// The hash of a motion's files: of the one, or of names and hashes of those in a folder, as
/// folder_hash has it.
[[nodiscard]] Result<std::string> hash_files(const std::vector<FormattedFile>& files);

/// The motion that a file in a format is made of: the one at its rate, else the first.
[[nodiscard]] std::size_t motion_of_format(MotionFormat format, const SaveOptions& options,
                                           std::span<const OutputMotion> motions);

/// `walk.csv`, or `standard output`; several parted by commas.
[[nodiscard]] std::string outputs_text(std::span<const WrittenFile> files);

}  // namespace retarget
