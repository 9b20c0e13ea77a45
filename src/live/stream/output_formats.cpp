#include "live/stream/output_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "live/stream/byte_output.h"
#include "live/stream/controller_outputs.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::string_view kByteText = "udp:, tcp:, files, -";

// Checks that the format supports the transport; ZeroMQ and Redis have one format each.
Result<void> check_format(const StreamAddress& to) {
  const std::string_view only = to.transport == Transport::kZmq     ? "sonic"
                                : to.transport == Transport::kRedis ? "twist2"
                                                                    : "";
  if (!only.empty()) {
    if (to.format.empty() || to.format == only) return {};
    return usage_failure(fmt::format("{} supports robot frames as {}, found format \"{}\"",
                                     to.text(), only, to.format));
  }
  if (to.format.empty()) return {};
  const auto formats = output_formats();
  const auto found = std::ranges::find(formats, to.format, &OutputFormat::name);
  if (found == formats.end()) {
    std::vector<std::string> names;
    for (const OutputFormat& format : formats) names.emplace_back(format.name);
    return usage_failure(fmt::format("robot frame formats are {}, found format \"{}\"",
                                     list_names(names), to.format),
                         did_you_mean(to.format, names));
  }
  if (found->port == 0) return {};
  return usage_failure(
      fmt::format("{} requires {}, found {}", found->name, found->places, to.text()));
}

}  // namespace

std::span<const OutputFormat> output_formats() {
  static const std::array<OutputFormat, 4> kFormats = {{
      {"jsonl",
       "JSON, one object per line: time, state, root, joints; the default",
       kByteText,
       0,
       {}},
      {"csv", "rows of Unitree's CSV; the default for .csv files", kByteText, 0, {}},
      {"sonic", "messages for SONIC's deployment, protocol version 1", "zmq:", 5556,
       has_zmq_output() ? "" : "ZeroMQ"},
      {"twist2", "Redis keys of TWIST2's controller", "redis:", 6379,
       has_redis_output() ? "" : "hiredis"},
  }};
  return kFormats;
}

Result<std::unique_ptr<FrameOutput>> open_frame_output(const StreamAddress& to,
                                                       const FrameOutputContext& context) {
  RETARGET_TRY(check_format(to));
  if (to.transport == Transport::kZmq) return open_zmq_output(to, context);
  if (to.transport == Transport::kRedis) return open_redis_output(to, context);
  return open_byte_output(to, context);
}

}  // namespace retarget
