#include "live/stream/stats_writer.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/try.h"
#include "live/stream/robot_frame_writer.h"

namespace retarget {
namespace {

double rounded(double value, double unit) {
  return std::isfinite(value) ? std::round(value / unit) * unit : 0.0;
}

}  // namespace

Result<StatsWriter> StatsWriter::open(const std::string& to) {
  StatsWriter writer;
  if (to == "-") {
    writer.to_ = Descriptor(::dup(STDOUT_FILENO));
    return writer;
  }
  constexpr int kMode = 0644;
  writer.to_ =
      Descriptor(::open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK, kMode));
  if (!writer.to_.is_open()) {
    return run_failure(to, std::string("cannot be written: ") + std::strerror(errno));
  }
  return writer;
}

void StatsWriter::write_if_due(double now, const LivePipeline& pipeline,
                               const SourceStatistics& source,
                               std::span<const OutputStatistics> outputs) {
  if (now < due_) return;
  const std::int64_t frames = pipeline.statistics().robot_frames;
  const double robot_fps = static_cast<double>(frames - frames_before_) / (now - before_);
  const std::string line = stats_line(now, pipeline, latency_, robot_fps, source, outputs);
  frames_before_ = frames;
  before_ = now;
  due_ = std::max(due_ + 1.0, now);
  latency_ = Latency();
  // A pipe that is ready accepts a line of this size completely.
  pollfd ready{to_.number(), POLLOUT, 0};
  if (::poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0) return;
  if (::write(to_.number(), line.data(), line.size()) < 0) return;
}

std::string stats_line(double now, const LivePipeline& pipeline, const Latency& latency,
                       double robot_fps, const SourceStatistics& source,
                       std::span<const OutputStatistics> outputs) {
  constexpr double kMilli = 1e-3, kMicro = 1e-6;
  const LiveStatistics live = pipeline.statistics();
  const PipelineStatistics& packets = pipeline.packets();
  nlohmann::ordered_json line = {
      {"time", rounded(now, kMilli)},
      {"state", live_state_name(pipeline.state())},
      {"packets", packets.packets},
      {"received", live.received},
      {"lost", live.lost},
      {"late", live.late},
      {"dropped",
       {{"malformed", packets.malformed},
        {"bad", live.bad},
        {"doubled", live.doubled},
        {"late", live.late},
        {"skipped", live.skipped},
        {"crowded", packets.crowded},
        {"overlong", source.dropped_lines},
        {"strangers", source.strangers}}},
      {"sender",
       {{"fps", rounded(live.frame_rate, kMilli)},
        {"clock_rate", rounded(live.sender_rate, kMicro)},
        {"delay_ms", rounded(1e3 * live.delay_s, kMilli)},
        {"jitter_ms", rounded(1e3 * live.jitter_s, kMilli)},
        {"clock_steps", live.clock_jumps},
        {"clock_anchors", live.clock_anchors}}},
      {"robot",
       {{"frames", live.robot_frames},
        {"fps", rounded(robot_fps, kMilli)},
        {"held", live.held},
        {"limited", live.limited},
        {"missed", live.missed}}},
      {"interruptions", live.interruptions},
      {"teleports", live.teleports},
      {"skeletons", {{"told", packets.skeletons}, {"refused", packets.refused_skeletons}}}};
  for (const OutputStatistics& output : outputs) {
    line["outputs"].push_back({{"to", output.name},
                               {"sent", output.sent},
                               {"dropped", output.dropped},
                               {"reconnects", output.reconnects},
                               {"closed", output.is_closed}});
  }
  if (latency.count() > 0) {
    line["latency_ms"] = {{"p50", rounded(1e3 * latency.percentile(50.0), kMilli)},
                          {"p99", rounded(1e3 * latency.percentile(99.0), kMilli)},
                          {"max", rounded(1e3 * latency.max(), kMilli)}};
  }
  return line.dump() + "\n";
}

}  // namespace retarget
