#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/load.h"
#include "retarget/measure.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/os.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/robot.h"
#include "retarget/solve.h"

namespace RETARGET_API retarget {

/// An output file of a motion.
struct OutputItem {
  MotionFormat format = MotionFormat::kCsv;
  std::string path;  ///< `-`: standard output.
};

/// A written file. If a run only computes hashes, the file does not exist.
struct WrittenFile {
  OutputItem item;
  std::string hash;     ///< Hash of its content, `sha256:...`.
  std::string sidecar;  ///< Text of its sidecar; empty: it has none.
  int frames = 0;       ///< Frames in the file.
  FrameRate rate;       ///< Frame rate of the file.
};

/// Returns the files for an output name and its formats. With one format the output is the file's
/// name. With several, each name is the output without .csv, .npz, .pkl or .glb, plus the format's
/// long extension: walk.csv, walk.mjlab.npz.
///
/// Usage errors: a repeated format, an ending that contradicts the format, .npz and .pkl without a
/// format, several formats to standard output.
[[nodiscard]] Result<std::vector<OutputItem>> plan_outputs(const std::string& output,
                                                           const SaveOptions& options);

/// Checks the name of an output of one fixed kind, such as `edit -o x.bvh`. A name without an
/// extension, or with one of no known kind of file, is allowed.
/// @param endings  extensions of this kind, in lower case.
/// @param kind     for the message: `a BVH file`.
/// Errors (kUsage): the extension of another kind of file; the hint lists `endings`.
[[nodiscard]] Result<void> check_output_ending(const std::string& path,
                                               std::initializer_list<std::string_view> endings,
                                               const std::string& kind);

/// Returns the frame rate of a format's file; tracking formats have their own rate.
/// @param motion  rate of the other formats.
[[nodiscard]] FrameRate rate_of_format(MotionFormat format, const SaveOptions& options,
                                       const FrameRate& motion);

/// Returns the distinct rates that the formats need; the motion's own rate comes first if a format
/// uses it. A fit solves the motion at each rate. The published method solves it at its own rate
/// only, and other rates are interpolated.
[[nodiscard]] std::vector<FrameRate> solved_rates(const SaveOptions& options, Method method,
                                                  const FrameRate& motion);

/// Returns the options for writing a motion.
/// @param output  its file name is also the name of the motion in formats that store one.
[[nodiscard]] WriteMotionOptions write_options(const std::string& output,
                                               const SaveOptions& options);

/// Receives messages and progress of a run, and may stop it. Option names in texts are marked
/// (spell_options).
class Observer {
 public:
  virtual ~Observer() = default;

  /// A line of the summary: a short label and a text.
  virtual void line(std::string_view /*label*/, std::string_view /*text*/) {}
  void lines(const std::vector<SummaryLine>& lines) {
    for (const auto& [label, text] : lines) line(label, text);
  }
  virtual void warn(const std::vector<Warning>& /*warnings*/, std::string_view /*file*/) {}
  /// An error that does not end the work.
  virtual void fault(const Error& /*error*/) {}
  virtual void progress(const Progress& /*progress*/) {}
  /// Progress of a longer task as text.
  virtual void status(std::string_view /*text*/) {}
  virtual void end_progress() {}
  /// While the returned object lives, an interrupt is reported only by is_stopped() and does not
  /// end the process. Hold it while unfinished files need cleanup.
  [[nodiscard]] virtual std::shared_ptr<void> hold_interrupts() { return {}; }
  /// Whether the work should stop. Called often, from any thread.
  [[nodiscard]] virtual bool is_stopped() const { return false; }
  /// Whether the summary is shown. If not, work that only serves the summary is skipped.
  [[nodiscard]] virtual bool is_read() const { return false; }
  /// The plan of a run that writes files, before it is solved.
  virtual void planned(const Plan& /*plan*/) {}
};

/// A set of files compared by identity instead of name: resolves hard and symbolic links, `a/../b`
/// and redirected standard streams.
class KnownFiles {
 public:
  /// Adds a file. Empty names are ignored.
  /// @param stream  the descriptor that `-` means: os::kStandardInput or os::kStandardOutput.
  void add(const std::string& path, int stream);
  /// The name under which the same file was added; null if it was not.
  [[nodiscard]] const std::string* find(const std::string& path, int stream) const;

 private:
  std::map<os::FileId, std::string> by_identity_;
  std::map<std::string, std::string> by_path_;  // Files that do not exist yet.
};

/// Checks the outputs of a command against its inputs.
class WrittenFiles {
 public:
  /// @param inputs  `-` is standard input; empty names are ignored.
  explicit WrittenFiles(const std::vector<std::string>& inputs);

  /// kUsage error if the file is an input. An empty name means no output.
  [[nodiscard]] Result<void> check_spared(const std::string& output) const;
  /// Adds an output. kUsage errors: the file is an input or another output; its folder is missing.
  [[nodiscard]] Result<void> take(const std::string& output);

 private:
  KnownFiles inputs_;
  KnownFiles outputs_;
};

/// Checks all outputs of a command with WrittenFiles::take.
[[nodiscard]] Result<void> check_written(const std::vector<std::string>& outputs,
                                         const std::vector<std::string>& inputs);

/// All files that a run reads: those named by its options, and those of its robot and the data
/// folder.
[[nodiscard]] std::vector<std::string> files_of(const Run& run, const std::string& data_folder);

/// Checks the output files of a motion before anything is read: folders exist, no output is also an
/// input, no file is written twice.
/// @param others  further output files; empty names are ignored.
[[nodiscard]] Result<void> check_outputs(const Run& run, bool sidecar,
                                         const std::vector<std::string>& inputs,
                                         const std::vector<std::string>& others);

/// Calls load_robot_motion with the facts that the sidecar of a CSV records (`walk.csv.json` for
/// `walk.csv`): rate, units, quaternion order and variant, which a CSV without a header lacks.
/// Given options take precedence. A sidecar is used only if its hash matches the file's content;
/// otherwise it is reported and ignored. Other files under its name are ignored.
/// Errors: those of load_robot_motion; a sidecar that records another robot (kInput).
[[nodiscard]] Result<RobotMotion> load_recorded_motion(const std::string& path,
                                                       const std::shared_ptr<const Robot>& robot,
                                                       const ReadMotionOptions& options);

/// Reports how a motion file was interpreted, and its warnings.
/// @param rate_option  option that states the rate if the file does not; marked (spell_options).
///   Empty: `source-fps`.
void report_reading(const std::string& file, const RobotMotion& motion, Observer& observer,
                    const std::string& rate_option = {});

/// Options for reading a run's motion. If it is a robot motion (SourceOptions::from_robot), the
/// sidecar of a CSV fills in options that are not given.
/// Errors: those of find_robot; a sidecar that records another robot (kInput).
[[nodiscard]] Result<SourceOptions> recorded_source(const std::string& path, SourceOptions options,
                                                    const DataFolder& data_folder);

/// The run that the sidecar of a motion records. Its options say which part of which source the
/// motion shows.
struct RecordedRun {
  Run run;
  bool mirror = false;      ///< RunRequest::mirror.
  std::string source_hash;  ///< Hash of its source; empty: unknown, as of standard input.
  std::string limits;       ///< Name or file of its limit set; empty: unknown.
  std::optional<TimeScale> time_scale = std::nullopt;
};
/// Returns nothing without a sidecar or if it is not used (see load_recorded_motion).
[[nodiscard]] std::optional<RecordedRun> recorded_run(const std::string& path);

/// Lines of the summary of a run.

/// Summary of the input clip.
[[nodiscard]] SummaryLine clip_line(const Clip& clip);
/// Results of a fit and its residuals. has_floor: the robot stands on a floor; verbose: include the
/// cost of each term.
[[nodiscard]] std::vector<SummaryLine> fit_lines(const FitReport& report, bool has_floor,
                                                 bool verbose);
/// Minimum distance to the joint limits, and joints that stay at a limit with the reason.
/// @param report  report on the motion; null: only the distance.
[[nodiscard]] std::vector<SummaryLine> limit_lines(const Motion& motion,
                                                   const QualityReport* report);

/// A missed gate: `jumps 3 (at most 0)`, or `jumps (not measured)`.
[[nodiscard]] std::string missed_text(const GateResult& gate);
/// All missed gates of a report, separated by commas. Empty if no gate is missed.
[[nodiscard]] std::string missed_gates_text(const QualityReport& report);

/// Warnings about solver failures.
[[nodiscard]] std::vector<Warning> solver_warnings(std::span<const SolverFailure> failures);

/// Missed gates with their values, and a verdict line with the number of passed gates and the joint
/// that is most often at its limit: `16 of 16 gates passed; waist_pitch at its limit in 46 % of
/// frames`.
/// @param file  name of the motion, if there may be several.
[[nodiscard]] std::vector<SummaryLine> verdict_lines(const QualityReport& report,
                                                     const std::string& file = {});

/// The content of a drawing, and a summary line about it: label and text.
struct DrawnFile {
  std::string bytes;
  SummaryLine line;
};

/// A file that shows the motion of a run and appears together with it. page_of_run and
/// picture_of_run (view.h) make drawings.
struct RunDrawing {
  std::string path;
  bool needs_report = false;  ///< `draw` gets the report of the motion's quality.
  /// Makes the content from the solved motion.
  std::function<Result<DrawnFile>(const Motion& motion, const QualityReport* report,
                                  Observer& observer)>
      draw;
};

/// Additional outputs and settings of a run.
struct RunRequest {
  std::string report;                ///< JSON report of the motion's quality; empty: none.
  std::vector<RunDrawing> drawings;  ///< Pages and renderings of the motion.
  std::string write_map;             ///< File for the map from joints to bones; empty: none.
  bool sidecar = false;              ///< Write `<output>.json` for each file.
  bool measure = false;              ///< Measure the motion's quality even if no report is written.
  bool verbose = false;              ///< Report the cost of each term of the fit.
  bool mirror = false;               ///< Retarget the mirror image of the clip (left-right).
  bool hashes_only = false;          ///< Compute hashes only; write nothing.
  bool partial = false;              ///< Skip formats that cannot represent so short a motion.
  bool dynamics = false;             ///< Include inverse dynamics in the measurement.
  int threads = 0;  ///< Threads per clip; 0: automatic. The result does not depend on it.
  std::optional<Gates> gates;  ///< Gates for the motion, which is then measured; empty: the default
                               ///< gates.
};

/// Result of a run.
struct RunOutcome {
  /// Frames and rate of the first file at the motion's rate; without one, of the first file.
  int frames = 0;
  double fps = 0.0;
  std::string config;                    ///< File of the retargeting configuration.
  std::vector<WrittenFile> motions;      ///< Files of the motion with their hashes.
  std::vector<Error> left_out;           ///< Errors of formats that were not written.
  std::vector<std::string> others;       ///< Sidecars, report and drawings.
  std::optional<QualityReport> quality;  ///< Set if requested.
};

/// Loads a robot and reports the files and properties found for it.
[[nodiscard]] Result<LoadedRobot> load_robot(const RobotChoice& choice,
                                             const DataFolder& data_folder, Observer& observer,
                                             Soles soles = Soles::kFound);

/// Reads the clip of a run, plans the run, and reports the properties of the clip.
[[nodiscard]] Result<Plan> read_and_plan(const Run& run, const RunRequest& request,
                                         const RobotSetup& robot, Observer& observer);

/// Plans a clip that has been read, like read_and_plan.
[[nodiscard]] Result<Plan> plan_clip(Clip clip, const Run& run, const RunRequest& request,
                                     const RobotSetup& robot, Observer& observer);

/// Writes a motion according to `output` and the options, like run_to_files: all of its files
/// appear together, or none. Reports losses of the formats and the written files.
/// @param contacts  contacts of the feet per frame, for formats that store them; empty: unknown.
/// Errors: those of plan_outputs, and of the formats.
[[nodiscard]] Result<std::vector<WrittenFile>> write_motion(
    const RobotClip& clip, const std::optional<FootContacts>& contacts, const std::string& output,
    const SaveOptions& options, Observer& observer);

/// Finds the human in a clip and writes a GLB of it. Reports how the clip was interpreted.
/// @param output  `-`: standard output.
/// Errors: those of find_data_folder, find_human and format_human_glb.
[[nodiscard]] Result<void> write_human_glb(const std::string& output, Clip clip,
                                           const HumanOptions& options,
                                           const DataFolder& data_folder, Observer& observer);

/// A motion to convert to other formats, and its options.
struct ConvertRequest {
  std::string input, output;
  RobotChoice robot;
  ReadingOptions reading;
  TimeOptions time{.fps = std::nullopt};  ///< No rate: that of the file.
  SaveOptions save;
  double memory_gb = 0.0;
  DataFolder data_folder;
};

/// Converts a robot motion: reads its file, changes its variant and its rate if requested, and
/// writes it with write_motion. If no option concerns a robot and the only output is a GLB, the
/// motion is a human's.
/// Errors: those of check_outputs, load_robot, load_recorded_motion, check_need and write_motion;
/// of a human, those of load_clip and write_human_glb; the robot has no such variant.
[[nodiscard]] Result<std::vector<WrittenFile>> convert_motion(const ConvertRequest& request,
                                                              Observer& observer);

/// Checks that the run recorded in a sidecar still gives the recorded bytes and report, by
/// repeating it without writing. Reports inputs that have changed since, and the agreement. Inputs
/// that moved together with the sidecar are found next to it.
/// Errors: not a sidecar, or a motion that cannot be read again (kInput); the errors of the run;
/// the output or its report differs, or its file has changed (kRun).
[[nodiscard]] Result<void> verify_run(const std::string& sidecar, const DataFolder& data_folder,
                                      Observer& observer);

/// Processes one clip from its file to the output files of a run: motion, sidecars, report,
/// drawings. All of them appear after everything was solved and written, or none.
[[nodiscard]] Result<RunOutcome> run_to_files(const Run& run, const RunRequest& request,
                                              const RobotSetup& robot, Observer& observer);

}  // namespace retarget
