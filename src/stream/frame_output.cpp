#include "stream/frame_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/suggest.h"
#include "base/try.h"
#include "stream/byte_sink.h"
#include "stream/robot_frame_writer.h"

namespace retarget {
namespace {

constexpr std::string_view kByteText = "udp:, tcp:, files, -";

// the forms that are bytes go wherever bytes go
class ByteOutput final : public FrameOutput {
 public:
  ByteOutput(ByteSink sink, std::unique_ptr<RobotFrameWriter> writer)
      : sink_(std::move(sink)), writer_(std::move(writer)) {}

  [[nodiscard]] Result<void> take(const RobotFrame& frame) override {
    constexpr int kHeaderEvery = 100;  // frames: receivers of datagrams may begin at any time
    const bool datagrams = sink_.address().transport == Transport::kUdp;
    if (datagrams && frame.index % kHeaderEvery == kHeaderEvery - 1) {
      TRY(sink_.write(writer_->header()));
    }
    bytes_.clear();
    writer_->append(frame, bytes_);
    return sink_.write(bytes_);
  }

 private:
  ByteSink sink_;
  std::unique_ptr<RobotFrameWriter> writer_;
  std::string bytes_;
};

Result<std::unique_ptr<FrameOutput>> open_byte_output(const StreamAddress& to,
                                                      const FrameOutputContext& context) {
  auto writer = make_frame_writer(to.format, to.file, context.robot, context.fps);
  TRY_ASSIGN(ByteSink sink, ByteSink::open(to));
  const std::string header = writer->header();
  if (!header.empty()) TRY(sink.write(header));
  return std::make_unique<ByteOutput>(std::move(sink), std::move(writer));
}

// what goes to one kind of place goes there alone
Result<void> check_format(const StreamAddress& to) {
  const std::string_view only = to.transport == Transport::kZmq     ? "sonic"
                                : to.transport == Transport::kRedis ? "twist2"
                                                                    : "";
  if (!only.empty()) {
    if (to.format.empty() || to.format == only) return {};
    return usage_failure(
        fmt::format("{} has robot frames as {}, found format \"{}\"", to.text(), only, to.format));
  }
  if (to.format.empty()) return {};
  const auto formats = output_formats();
  const auto found = std::ranges::find(formats, to.format, &OutputFormat::name);
  if (found == formats.end()) {
    std::vector<std::string> names;
    for (const OutputFormat& format : formats) names.emplace_back(format.name);
    return usage_failure(fmt::format("robot frames are written as {}, found format \"{}\"",
                                     list_names(names), to.format),
                         did_you_mean(to.format, names));
  }
  if (found->port == 0) return {};
  return usage_failure(
      fmt::format("{} goes to {}, not to {}", found->name, found->places, to.text()));
}

}  // namespace

std::span<const OutputFormat> output_formats() {
  static const std::array<OutputFormat, 4> kFormats = {{
      {"jsonl",
       "JSON, one object a line: time, state, root, joints; the default",
       kByteText,
       0,
       {}},
      {"csv", "rows of Unitree's CSV; the default of files that end so", kByteText, 0, {}},
      {"sonic", "messages for SONIC's deployment, protocol version 1", "zmq:", 5556,
       has_zmq_output() ? "" : "ZeroMQ"},
      {"twist2", "keys that TWIST2's controller reads", "redis:", 6379,
       has_redis_output() ? "" : "hiredis"},
  }};
  return kFormats;
}

Result<std::unique_ptr<FrameOutput>> open_frame_output(const StreamAddress& to,
                                                       const FrameOutputContext& context) {
  TRY(check_format(to));
  if (to.transport == Transport::kZmq) return open_zmq_output(to, context);
  if (to.transport == Transport::kRedis) return open_redis_output(to, context);
  return open_byte_output(to, context);
}

Result<void> check_extras(const StreamAddress& address, std::span<const std::string> known) {
  for (const auto& [name, value] : address.extras) {
    if (std::ranges::find(known, name) != known.end()) continue;
    return usage_failure(fmt::format("{} knows no {}={}", address.text(), name, value),
                         did_you_mean(name, known));
  }
  return {};
}

Failure lacks_library(const StreamAddress& to, std::string_view library, std::string_view package) {
  return usage_failure(fmt::format("this build lacks {}; {} needs it", library, to.text()),
                       fmt::format("install {} and build again (docs/building.md)", package));
}

}  // namespace retarget
