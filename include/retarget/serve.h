#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/live.h"
#include "retarget/options.h"
#include "retarget/plan.h"

// Streams over sockets, pipes and files, on top of live.h. Link retarget::live.
namespace RETARGET_API retarget {

/// Receives a human-readable message: a label and a text with marked options.
using LiveTell = std::function<void(std::string_view label, std::string_view text)>;

class WriterThread;

/// Writes text on a thread, so that a reader that pauses does not delay the caller. Text that the
/// reader does not read in time is dropped. For the messages of a live run: LiveTell is called
/// while robot frames wait.
class MessageWriter {
 public:
  /// @param descriptor  a file, a pipe or a terminal; duplicated.
  explicit MessageWriter(int descriptor);
  /// Waits for queued text, for half a second if the reader reads nothing.
  ~MessageWriter();
  MessageWriter(MessageWriter&&) noexcept;
  MessageWriter& operator=(MessageWriter&&) noexcept;

  /// Queues a text, or drops it if the queue is full.
  void write(std::string_view text);

 private:
  std::unique_ptr<WriterThread> thread_;
};

/// Calibration of the body of a stream.
enum class LiveCalibration : unsigned char {
  kAuto,   ///< Uses the skeleton's file or header.
  kTpose,  ///< Uses a T-pose some seconds after the first frame.
  kNpose,  ///< Uses a pose with arms down some seconds after the first frame.
};

/// The clock that sets the pace of robot frames.
enum class LivePace : unsigned char {
  kAuto,   ///< kInput from standard input to files, otherwise kClock.
  kClock,  ///< Wall clock: one frame every 1 / fps seconds, regardless of the input.
  kInput,  ///< Input timestamps, as fast as they arrive: for motions sent through a pipe.
};

/// Options of a stream's retargeting.
struct LivePipelineOptions {
  LiveOptions live;
  Options run;  ///< How to recognise the human and solve for the robot.
  LiveCalibration calibrate = LiveCalibration::kAuto;
  double calibrate_after_s = 3.0;
  LivePace pace = LivePace::kAuto;  ///< The pipeline treats kAuto as kClock.
  /// Recognise new bodies of a running stream on another thread. Set by serve.
  bool in_background = false;
};

/// Counters of a stream's packets that LiveStatistics does not contain.
struct PipelineStatistics {
  std::int64_t packets = 0;
  std::int64_t malformed = 0;  ///< Dropped packets: invalid, or with frames of another skeleton.
  std::int64_t crowded = 0;    ///< Dropped frames: too many in one packet.
  std::int64_t foreign = 0;    ///< Dropped frames: of a new sender whose skeleton is missing.
  int skeletons = 0;           ///< Skeletons received.
  /// Rejected skeletons: not human or unusable; the previous body was kept.
  int refused_skeletons = 0;
};

/// Statistics of an output's robot frames.
struct OutputStatistics {
  std::string name;             ///< Address of the output.
  std::int64_t sent = 0;        ///< Frames sent completely.
  std::int64_t dropped = 0;     ///< Frames that the receiver did not accept.
  std::int64_t reconnects = 0;  ///< Connections after the first one.
  std::string last_error;       ///< Empty: none.
  bool is_closed = false;       ///< Accepts no more frames.
  bool is_incomplete = false;   ///< The output is a file that lacks frames.
};

/// Options of a live run: receives packets from one input and sends robot frames to several outputs
/// until stopped.
struct ServeOptions {
  LivePipelineOptions pipeline;
  std::string input = "stdin";  ///< An address: `udp:1118?format=bvh`, `stdin`, ... (docs/live.md).
  std::vector<std::string> outputs;  ///< Addresses; empty: standard output.
  std::optional<Clip> skeleton;      ///< Skeleton from a file; empty: none.
  double seconds = 0.0;              ///< Duration of the run, seconds; 0: unlimited.
  double silent_s = 0.0;             ///< End after this time without input; 0: never.
  std::string record;                ///< Folder in which to record input and output; empty: none.
  std::string replay;  ///< Recorded folder to replay instead of the input; empty: none.
  std::string stats;   ///< File for statistics, - for standard output; empty: none.
};

/// Callbacks of the caller of serve.
struct ServeControl {
  std::function<bool()> is_stopped;       ///< Polled frequently.
  std::function<bool()> is_recalibrated;  ///< Whether requested since the last call.
  LiveTell tell;                          ///< Receives human-readable messages.
};

/// Times from the arrival of a packet to the departure of the first frame that shows it, seconds;
/// percentiles are accurate to 5 %. 0 without frames.
struct LatencySummary {
  double p50_s = 0.0, p99_s = 0.0, max_s = 0.0;
};

/// Result of a live run.
struct ServeSummary {
  LiveStatistics live;
  PipelineStatistics packets;
  LatencySummary latency;
  std::vector<OutputStatistics> outputs;
  Result<void> written;         ///< Error if a file or a recording is incomplete.
  std::optional<Error> unused;  ///< Why the packets gave no robot frame; empty if they gave any.
};

/// Resolves kAuto: from standard input to files and standard output the input sets the pace,
/// otherwise the clock.
[[nodiscard]] Result<LivePace> chosen_pace(const ServeOptions& options);

/// Checks a run before it opens, creates or discards anything. serve() does it first. Errors:
/// contradictory options, addresses that cannot be, a folder that is missing or already contains a
/// recording (kUsage); files that the options name and that cannot be read (kConfig); a recording
/// to replay that is missing (kInput).
[[nodiscard]] Result<void> check_serve(const ServeOptions& options);

/// Runs until it is stopped, its duration is over or its input ends. Files are opened after
/// everything else, because opening a file discards its content.
///
/// Errors: those of check_serve; an output that is an input or another output (kUsage); unavailable
/// addresses; an unrecognised body. A failing output is
/// not an error of the run: the others continue. The run ends when no output accepts frames.
[[nodiscard]] Result<ServeSummary> serve(const RobotSetup& robot, const ServeOptions& options,
                                         const ServeControl& control);

/// How to play a clip to an address.
struct PlayOptions {
  std::string to = "stdout";
  double speed = 1.0;       ///< Playback speed factor; 0: as fast as possible.
  bool header = true;       ///< Send the skeleton first.
  HumanOptions human;       ///< How to recognise the human, for formats with fixed bones.
  std::string data_folder;  ///< Contains configs/skeletons, for the same formats.
};

/// Sends a clip as its motion capture system would have; returns when the clip ends or on stop.
/// @return number of frames sent. Errors: unavailable addresses; no human found in a clip to be
///   played in a format with fixed bones.
[[nodiscard]] Result<int> play(const Clip& clip, const PlayOptions& options,
                               const std::function<bool()>& is_stopped);

/// A stream format with human motion.
struct InputFormat {
  std::string_view name;         ///< `bvh`, `lines`
  std::string_view description;  ///< Human-readable, one line.
  int port = 0;                  ///< Default port of its senders; 0: none.
};

/// All stream formats with human motion, the default first.
[[nodiscard]] std::vector<InputFormat> input_formats();

/// A stream format with robot frames.
struct OutputFormat {
  std::string_view name;         ///< `jsonl`, `sonic`
  std::string_view description;  ///< Human-readable, one line.
  std::string_view places;       ///< Supported addresses, human-readable.
  int port = 0;                  ///< Default port of its readers; 0: none.
  std::string_view lacks;        ///< Library missing in this build; empty: none.
};

/// All stream formats with robot frames.
[[nodiscard]] std::span<const OutputFormat> output_formats();

}  // namespace retarget
