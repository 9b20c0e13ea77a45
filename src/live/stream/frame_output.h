#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"
#include "retarget/serve.h"

namespace retarget {

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
  LiveTell tell = {};
  /// Files and standard output never drop frames but may block the run: for inputs that can wait,
  /// such as pipes.
  bool waits = false;
  std::function<bool()> is_stopped = {};  ///< Ends all waiting; may be empty.
  /// Joints held in the standing pose, for robots of which only the arms follow.
  std::vector<std::string> held = {};
};

}  // namespace retarget
