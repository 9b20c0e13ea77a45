#include "live/stream/frame_output.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "live/stream/byte_output.h"
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

Failure lacks_library(const StreamAddress& to, std::string_view library, std::string_view package) {
  return usage_failure(fmt::format("this build lacks {}; {} needs it", library, to.text()),
                       fmt::format("install {} and rebuild (docs/building.md)", package));
}

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

Result<void> Outputs::add(const StreamAddress& to, const FrameOutputContext& context) {
  RETARGET_TRY_ASSIGN(auto output, open_frame_output(to, context));
  all_.push_back(std::move(output));
  return {};
}

void Outputs::take(const RobotFrame& frame) {
  ++frames_;
  for (const auto& output : all_) output->take(frame);
}

bool Outputs::are_closed() const {
  return std::ranges::all_of(all_,
                             [](const auto& output) { return output->statistics().is_closed; });
}

Result<void> Outputs::finish() {
  for (const auto& output : all_) output->finish();
  for (const OutputStatistics& each : statistics()) {
    if (!each.is_incomplete) continue;
    return run_failure(each.name,
                       fmt::format("{} could not be written: {}",
                                   count_text(each.dropped, "robot frame"), each.last_error));
  }
  return {};
}

std::vector<OutputStatistics> Outputs::statistics() const {
  std::vector<OutputStatistics> all;
  all.reserve(all_.size());
  for (const auto& output : all_) all.push_back(output->statistics());
  return all;
}

}  // namespace retarget
