#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"

namespace retarget {

/// Encodes robot frames as bytes.
class RobotFrameWriter {
 public:
  virtual ~RobotFrameWriter() = default;
  /// Bytes that receivers need first; empty: none.
  [[nodiscard]] virtual std::string header() const = 0;
  /// Appends a frame.
  virtual void append(const RobotFrame& frame, std::string& bytes) = 0;
};

/// Writes JSON lines: `{"frame", "time", "state", "root_position", "root_rotation" w x y z,
/// "joints"}`; the first line names robot, rate and joints.
/// @param held  joints that do not follow; if any, the first line names them and the root.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_json_frame_writer(
    std::shared_ptr<const Robot> robot, double fps, std::vector<std::string> held = {});
/// Writes rows of Unitree's CSV, as offline runs do.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_csv_frame_writer(
    std::shared_ptr<const Robot> robot);

/// @param format  `jsonl` or `csv`; empty: `csv` for files with this extension, otherwise `jsonl`.
[[nodiscard]] std::unique_ptr<RobotFrameWriter> make_frame_writer(
    const std::string& format, const std::string& file, std::shared_ptr<const Robot> robot,
    double fps, std::vector<std::string> held = {});

/// Name of a state: `following`, `holding`, ...
[[nodiscard]] std::string_view live_state_name(LiveState state);

}  // namespace retarget
