#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"

namespace retarget {

/// Robot frames as bytes.
class RobotFrameWriter {
 public:
  virtual ~RobotFrameWriter() = default;
  /// What receivers must know first; empty: nothing.
  [[nodiscard]] virtual std::string header() const = 0;
  /// Appends a frame.
  virtual void append(const RobotFrame& frame, std::string& bytes) = 0;
};

/// JSON lines: `{"frame", "time", "state", "root_position", "root_rotation" w x y z, "joints"}`; the
/// first line names robot, rate and joints.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_json_frame_writer(
    std::shared_ptr<const Robot> robot, double fps);
/// Rows of Unitree's CSV, as offline runs write it.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_csv_frame_writer(
    std::shared_ptr<const Robot> robot);

/// @param format  `jsonl` or `csv`; empty: `csv` for files that end so, else `jsonl`.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_frame_writer(
    const std::string& format, const std::string& file, std::shared_ptr<const Robot> robot,
    double fps);

/// `following`, `holding`, ...
[[nodiscard]] std::string_view live_state_name(LiveState state);

}  // namespace retarget
