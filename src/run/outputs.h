#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/file.h"
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
  /// @param motion   the frames that add() took.
  /// @param human    what the motion came from, for files that show it; nothing: not known.
  /// @param sidecar  makes `<output>.json` beside each file; null: none.
  [[nodiscard]] Result<std::vector<WrittenFile>> finish(const RobotClip& motion,
                                                        std::optional<HumanInWorld> human = {},
                                                        const SidecarText& sidecar = {});

 private:
  MotionOutputs() = default;
  Result<void> write_others(const RobotClip& motion);

  SaveOptions options_;
  WriteMotionOptions write_options_;
  bool in_memory_ = false;
  std::vector<OutputItem> items_;
  std::vector<std::unique_ptr<CsvSink>> sinks_;    // by item; null: no CSV
  std::vector<std::optional<OutputFile>> others_;  // by item; nothing: a CSV
  std::vector<OutputFile> sidecars_;
  std::vector<WrittenFile> written_;
};

/// `walk.csv`, or `standard output`; several parted by commas.
[[nodiscard]] std::string outputs_text(std::span<const WrittenFile> files);

}  // namespace retarget
