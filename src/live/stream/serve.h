#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "live/stream/frame_output.h"
#include "live/stream/latency.h"
#include "live/stream/live_pipeline.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/plan.h"

namespace retarget {

/// Options of a live run: receives packets from one input and sends robot frames to several outputs
/// until stopped.
struct ServeOptions {
  LivePipelineOptions pipeline;
  std::string input = "stdin";       ///< An address (stream_address.h).
  std::vector<std::string> outputs;  ///< Addresses; empty: standard output.
  std::optional<Clip> skeleton;      ///< From a file.
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
  LivePipeline::Tell tell;                ///< Receives human-readable messages.
};

struct ServeSummary {
  LiveStatistics live;
  PipelineStatistics packets;
  Latency latency;  ///< From arrival of a packet to departure of the first frame that shows it.
  std::vector<OutputStatistics> outputs;
  Result<void> written;  ///< Error if a file or a recording is incomplete.
};

/// Resolves kAuto: from standard input to files and standard output the input sets the pace,
/// otherwise the clock.
[[nodiscard]] Result<LivePace> chosen_pace(const ServeOptions& options);

/// Runs until it is stopped, its duration is over or its input ends.
///
/// Errors: unavailable addresses; an unrecognised body. A failing output is not an error of the
/// run: the others continue. The run ends when no output accepts frames any more.
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

}  // namespace retarget
