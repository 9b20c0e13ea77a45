#include <algorithm>
#include <cerrno>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "live/stream/stats_writer.h"
#include "retarget/os.h"

namespace retarget {
namespace {

constexpr double kFirst = 1e-6;  // seconds
constexpr double kGrowth = 1.05;

}  // namespace

void Latency::add(double seconds) {
  std::size_t size = 0;
  for (double bound = kFirst; bound < seconds && size + 1 < counts_.size(); bound *= kGrowth) {
    ++size;
  }
  ++counts_[size];
  ++count_;
  max_ = std::max(max_, seconds);
}

double Latency::percentile(double percent) const {
  const double wanted = 0.01 * percent * static_cast<double>(count_);
  double bound = kFirst;
  std::int64_t below = 0;
  for (const std::int64_t count : counts_) {
    below += count;
    if (below > 0 && static_cast<double>(below) >= wanted) return std::min(bound, max_);
    bound *= kGrowth;
  }
  return max_;
}

namespace {

constexpr FrameBytesQueue::Bounds kWaitingLines = {4, std::size_t{64} << 10};

// Rounds to a multiple of 1 / parts, to the nearest number that prints as such.
double rounded(double value, double parts) {
  return std::isfinite(value) ? std::round(value * parts) / parts : 0.0;
}

// Formats one line of statistics.
std::string stats_line(double now, const LivePipeline& pipeline, const Latency& latency,
                       double robot_fps, const SourceStatistics& source,
                       std::span<const OutputStatistics> outputs) {
  constexpr double kMilli = 1e3, kMicro = 1e6;
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
        {"foreign", packets.foreign},
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

}  // namespace

StatsWriter::StatsWriter(Descriptor to)
    : thread_(std::make_unique<WriterThread>(std::move(to), kWaitingLines)) {}

Result<StatsWriter> StatsWriter::open(const std::string& to) {
  if (to == "-") return StatsWriter(standard_stream(1));
  Descriptor file(os::open_file(to, os::OpenFor::kReplacing));
  if (!file.is_open()) {
    return run_failure(to, std::string("cannot be written: ") + error_text(errno));
  }
  return StatsWriter(std::move(file));
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
  static_cast<void>(thread_->put(line));
}

void StatsWriter::finish() {
  thread_->finish(false, {});
}

}  // namespace retarget
