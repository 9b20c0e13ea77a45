#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"

namespace retarget {

/// Receives a human-readable message: a label and a text.
using OutputTell = std::function<void(std::string_view label, std::string_view text)>;

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

/// A destination of robot frames. No receiver delays the others: frames that a receiver does not
/// accept in time are dropped for it and counted.
class FrameOutput {
 public:
  virtual ~FrameOutput() = default;
  /// Sends a frame or drops it.
  virtual void take(const RobotFrame& frame) = 0;
  /// Sends buffered frames, either for a short time or until the receiver has accepted them.
  virtual void finish() {}
  [[nodiscard]] virtual const OutputStatistics& statistics() const = 0;
};

/// Parameters for opening an output.
struct FrameOutputContext {
  std::shared_ptr<const Robot> robot;
  double fps = 50.0;
  OutputTell tell = {};
  /// Files and standard output never drop frames but may block the run: for inputs that can wait,
  /// such as pipes.
  bool waits = false;
  std::function<bool()> is_stopped = {};  ///< Ends all waiting; may be empty.
  /// Joints held in the standing pose, for robots of which only the arms follow.
  std::vector<std::string> held = {};
};

}  // namespace retarget
