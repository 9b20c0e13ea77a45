#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/plan.h"
#include "stream/latency.h"
#include "stream/live_pipeline.h"

namespace retarget {

/// A live run: packets from one place, robot frames to others, until it is stopped.
struct ServeOptions {
  LivePipelineOptions pipeline;
  std::string input = "stdin";       ///< An address (stream_address.h).
  std::vector<std::string> outputs;  ///< Addresses; none: standard output.
  std::optional<Clip> skeleton;      ///< Of a file.
  double seconds = 0.0;              ///< Ends after so long; 0: does not.
  double silent_s = 0.0;             ///< Ends when nothing came for so long; 0: does not.
  std::string record;                ///< Folder for input and output as they were; empty: none.
  std::string replay;                ///< Such a folder in place of the input; empty: none.
};

/// Who runs it.
struct ServeControl {
  std::function<bool()> is_stopped;       ///< Asked often.
  std::function<bool()> is_recalibrated;  ///< Whether that was asked for since the last call.
  LivePipeline::Tell tell;                ///< Lines for people.
};

struct ServeSummary {
  LiveStatistics live;
  PipelineStatistics packets;
  Latency latency;  ///< From a packet's arrival to its frames' departure.
};

/// Runs until it is stopped, its time is over or its input ends.
///
/// Errors: addresses that cannot be had; a body that cannot be recognised; outputs that fail.
[[nodiscard]] Result<ServeSummary> serve(const RobotSetup& robot, const ServeOptions& options,
                                         const ServeControl& control);

/// How a clip is played to an address.
struct PlayOptions {
  std::string to = "stdout";
  double speed = 1.0;  ///< Times its own; 0: as fast as it goes.
  bool header = true;  ///< The skeleton is sent first.
  HumanOptions human;  ///< How the human is recognised, for formats that have bones of their own.
  std::string data_folder;  ///< With configs/skeletons, for the same formats.
};

/// Sends a clip as its capture would have; ends when it ends or is stopped.
/// @return frames sent. Errors: addresses that cannot be had; no human in a clip that is to be played in a
///     format with bones of its own.
[[nodiscard]] Result<int> play(const Clip& clip, const PlayOptions& options,
                               const std::function<bool()>& is_stopped);

}  // namespace retarget
