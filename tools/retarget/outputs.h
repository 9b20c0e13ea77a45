#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "csv_sink.h"
#include "options.h"
#include "retarget/motion_io.h"

namespace retarget::cli {

/// A file that a run makes.
struct OutputItem {
  MotionFormat format = MotionFormat::kCsv;
  std::string path;  ///< `-`: standard output.
};

/// Which files -o and --format name. One format: -o is the file's name. Several: each name is that
/// of -o, without .csv, .npz or .pkl at its end, and the format's long ending: walk.csv,
/// walk.mjlab.npz.
///
/// Usage errors: a format twice or unknown, an ending that says another kind of file than the
/// format, .npz and .pkl without a format, several formats to standard output.
[[nodiscard]] Result<std::vector<OutputItem>> plan_outputs(const OutputOptions& options);

/// The same, and whether everything can be written: folders are there, no file is also an input,
/// no file is written twice.
/// @param inputs         files that are read; empty names are passed over.
/// @param other_outputs  files that are written besides.
[[nodiscard]] Result<void> check_outputs(const OutputOptions& options,
                                         const std::vector<std::string>& inputs,
                                         const std::vector<std::string>& other_outputs);

/// How the options want a motion to be written.
[[nodiscard]] Result<WriteMotionOptions> write_options(const OutputOptions& options);

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
      const OutputOptions& options, std::shared_ptr<const Robot> robot, const FrameRate& rate,
      bool in_memory = false);

  /// Takes the next frame: CSVs are written while frames are solved.
  void add(std::span<const double> qpos);

  /// Formats what is no CSV, writes everything and puts it in its place.
  /// @param motion   the frames that add() took.
  /// @param sidecar  makes `<output>.json` beside each file; null: none.
  [[nodiscard]] Result<std::vector<WrittenFile>> finish(const RobotClip& motion,
                                                        const SidecarText& sidecar = {});

 private:
  MotionOutputs() = default;
  Result<void> write_others(const RobotClip& motion);

  OutputOptions options_;
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

}  // namespace retarget::cli
