#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "app/plan/motion_target.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/hash.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/normalize_start.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/run.h"
#include "retarget/scene.h"
#include "retarget/solved_scene.h"

namespace retarget {

/// Writes a robot CSV while its frames are being solved. A second thread formats and writes frames
/// as they arrive, which saves time and memory at the end. Output to standard output or a pipe
/// waits until all frames are complete.
class CsvSink {
 public:
  struct Options {
    RobotCsvOptions csv;
    bool normalize_start = false;
  };

  /// @param path  empty: nothing is written, only the hash is computed.
  [[nodiscard]] static Result<std::unique_ptr<CsvSink>> open(const std::string& path,
                                                             std::shared_ptr<const Robot> robot,
                                                             const Options& options);
  ~CsvSink();
  CsvSink(const CsvSink&) = delete;
  CsvSink& operator=(const CsvSink&) = delete;

  /// Adds the next frame.
  void add(std::span<const double> qpos);

  /// Writes the remaining frames. Returns the hash of the whole text.
  [[nodiscard]] Result<std::string> flush();
  /// Moves the file to its final path; call after flush. Without commit, no file remains.
  [[nodiscard]] Result<void> commit();

 private:
  CsvSink(std::optional<OutputFile> file, ContentHasher hasher, std::shared_ptr<const Robot> robot,
          const Options& options);

  void hand_over();
  void write_chunks();
  void write_frames(std::vector<double>& frames);
  void write_text();

  std::optional<OutputFile> file_;
  const std::shared_ptr<const Robot> robot_;
  const Options options_;
  const RobotCsvFormatter formatter_;
  std::vector<double> filling_;  // Consecutive frames from add().

  // Used by the writing thread, or by the caller's thread if there is none.
  std::optional<StartNormalizer> normalizer_;
  std::string text_;
  ContentHasher hasher_;
  int frames_ = 0;  // Written frames.
  Result<void> written_;
  std::vector<double> writing_;  // Frames that the writing thread has taken.

  std::thread writer_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<double> waiting_;  // Frames for the writer; empty when it has taken them.
  bool done_ = false;
};

/// A motion to write.
struct OutputMotion {
  const RobotClip* clip = nullptr;                ///< Must outlive the writing.
  std::optional<HumanInWorld> human;              ///< The source motion, for formats that show it.
  std::optional<FootContacts> contacts;           ///< Empty if unknown.
  std::optional<SceneClip> scene = std::nullopt;  ///< Scene of the robot; empty: none.
  std::optional<ContactLabels> labels = std::nullopt;  ///< Contacts in the scene.
  const LimitSet* limits = nullptr;  ///< Joint ranges for a reference; null: the robot's default.
};

/// Formats the sidecar of a file.
using SidecarText = std::function<Result<std::string>(const WrittenFile&)>;

/// All files of one motion. They appear together after everything was formatted and written, or not
/// at all. Only an error during the final renames can leave some of them.
class MotionOutputs {
 public:
  /// kHash computes hashes and writes nothing; kConversion keeps all frames (conversion_options).
  enum class Purpose : std::uint8_t { kRun, kHash, kConversion };

  /// Opens the outputs of a motion.
  /// @param rate  frame rate of the motion.
  [[nodiscard]] static Result<std::unique_ptr<MotionOutputs>> open(
      const std::string& output, const SaveOptions& options,
      const std::shared_ptr<const Robot>& robot, const FrameRate& rate, Purpose purpose);

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

  /// Files of the motion.
  [[nodiscard]] const std::vector<OutputItem>& items() const { return items_; }
  /// Lines for the summary about the reference, after finish().
  [[nodiscard]] const std::vector<SummaryLine>& lines() const { return lines_; }

 private:
  MotionOutputs() = default;
  Result<void> write_others(std::span<const OutputMotion> motions, std::vector<Error>* left_out);
  Result<void> write_beside(const OutputMotion& motion);
  Result<void> commit();

  SaveOptions options_;
  WriteMotionOptions write_options_;
  bool in_memory_ = false;
  std::vector<OutputItem> items_;
  std::vector<std::unique_ptr<CsvSink>> sinks_;      // One per item; null: not a CSV.
  std::vector<std::optional<MotionTarget>> others_;  // One per item; nothing: a CSV.
  std::vector<OutputFile> sidecars_;  // Includes the files of contacts, scene and reference.
  std::string reference_;             // Path of the reference; empty: none.
  std::vector<SummaryLine> lines_;
  std::vector<WrittenFile> written_;
};

/// Hash of a motion's files: of the single file, or of names and hashes of the files in a folder,
/// as in folder_hash.
[[nodiscard]] Result<std::string> hash_files(const std::vector<FormattedFile>& files);

/// Index of the motion from which a file of this format is made: the one at its rate, otherwise the
/// first.
/// @param rates  frame rates of the motions.
[[nodiscard]] std::size_t motion_of_format(MotionFormat format, const SaveOptions& options,
                                           std::span<const FrameRate> rates);

/// Warns about motion data that the output formats cannot store.
void warn_of_losses(const RobotClip& motion, std::span<const WrittenFile> files,
                    const SaveOptions& options, Observer& observer);

/// `500 frames at 50 fps`.
[[nodiscard]] std::string frames_text(int frames, const FrameRate& rate);

/// File names such as `walk.csv`, or `standard output`, separated by commas. Files whose frames are
/// not those of the motion have their number and rate: `walk.npz (500 frames at 50 fps)`.
/// @param motion  null: names only.
[[nodiscard]] std::string outputs_text(std::span<const WrittenFile> files,
                                       const RobotClip* motion = nullptr);

}  // namespace retarget
