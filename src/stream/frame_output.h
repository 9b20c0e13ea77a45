#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/live.h"
#include "retarget/robot.h"
#include "stream/stream_address.h"

namespace retarget {

/// A place that robot frames go to.
class FrameOutput {
 public:
  virtual ~FrameOutput() = default;
  /// Errors end the run: what was opened can be written no more.
  [[nodiscard]] virtual Result<void> take(const RobotFrame& frame) = 0;
};

/// What an output is opened with.
struct FrameOutputContext {
  std::shared_ptr<const Robot> robot;
  double fps = 50.0;
  /// Lines for people: a label, and what there is to say.
  std::function<void(std::string_view label, std::string_view text)> tell;
};

/// A form of robot frames.
struct OutputFormat {
  std::string_view name;         ///< `jsonl`, `sonic`
  std::string_view description;  ///< For people, a line.
  std::string_view places;       ///< Addresses that it goes to, for people.
  int port = 0;                  ///< Where its readers look by default; 0: anywhere.
  std::string_view lacks;        ///< The library that this build was made without; empty: none.
};

/// All of them.
[[nodiscard]] std::span<const OutputFormat> output_formats();

/// Errors: an address that cannot be had; a format that is unknown, does not go there or is not for
/// this robot (kUsage).
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_frame_output(
    const StreamAddress& to, const FrameOutputContext& context);

/// `zmq:PORT` and `redis:PORT`. Errors: as above; a build without their library (kUsage).
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_zmq_output(
    const StreamAddress& to, const FrameOutputContext& context);
[[nodiscard]] Result<std::unique_ptr<FrameOutput>> open_redis_output(
    const StreamAddress& to, const FrameOutputContext& context);
/// Whether this build has them.
[[nodiscard]] bool has_zmq_output();
[[nodiscard]] bool has_redis_output();

/// kUsage error for parts behind `?` that an address may not have.
[[nodiscard]] Result<void> check_extras(const StreamAddress& address,
                                        std::span<const std::string> known);
/// The error of a build without a library.
[[nodiscard]] Failure lacks_library(const StreamAddress& to, std::string_view library,
                                    std::string_view package);

}  // namespace retarget
