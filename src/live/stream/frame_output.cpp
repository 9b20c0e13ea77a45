#include "live/stream/frame_output.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "live/stream/byte_output.h"
#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::string_view kByteText = "udp:, tcp:, files, -";

// How frames leave through a library.
struct LibraryOutput {
  decltype(&open_frame_output) open = nullptr;
  std::string_view lacks = {};    // The library if this build does not have it.
  std::string_view package = {};  // Package of that library.
};

#ifdef RETARGET_HAS_ZEROMQ
constexpr LibraryOutput kZmq = {.open = open_zmq_output};
#else
constexpr LibraryOutput kZmq = {.lacks = "ZeroMQ", .package = "libzmq3-dev"};
#endif
#ifdef RETARGET_HAS_HIREDIS
constexpr LibraryOutput kRedis = {.open = open_redis_output};
#else
constexpr LibraryOutput kRedis = {.lacks = "hiredis", .package = "libhiredis-dev"};
#endif

Result<std::unique_ptr<FrameOutput>> open_library_output(const LibraryOutput& library,
                                                         const StreamAddress& to,
                                                         const FrameOutputContext& context) {
  if (library.lacks.empty()) return library.open(to, context);
  return usage_failure(fmt::format("this build lacks {}; {} needs it", library.lacks, to.text()),
                       fmt::format("install {} and rebuild (docs/building.md)", library.package));
}

// Checks that the format supports the transport; ZeroMQ and Redis have one format each.
Result<void> check_output_format(const StreamAddress& to) {
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
    return usage_failure(fmt::format("robot frame formats are {}, found format \"{}\"{}",
                                     list_names(names), to.format, did_you_mean(to.format, names)));
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
      {"sonic", "messages for SONIC's deployment, protocol version 1", "zmq:", 5556, kZmq.lacks},
      {"twist2", "Redis keys of TWIST2's controller", "redis:", 6379, kRedis.lacks},
  }};
  return kFormats;
}

Result<void> check_frame_output(const StreamAddress& to) {
  RETARGET_TRY(check_output_format(to));
  switch (to.transport) {
    case Transport::kStdin:
      return usage_failure("cannot send to standard input");
    case Transport::kZmq:
    case Transport::kRedis:
      return {};
    case Transport::kUdp:
      RETARGET_TRY(check_extras(to, std::array<std::string, 1>{"interface"}));
      break;
    default:
      RETARGET_TRY(check_extras(to, {}));
  }
  if (to.transport == Transport::kFile) return check_output_folder(to.file);
  if (to.transport == Transport::kStdout || to.port != 0) return {};
  return usage_failure(to.text() + " has no destination port");
}

Result<std::unique_ptr<FrameOutput>> open_frame_output(const StreamAddress& to,
                                                       const FrameOutputContext& context) {
  RETARGET_TRY(check_frame_output(to));
  if (to.transport == Transport::kZmq) return open_library_output(kZmq, to, context);
  if (to.transport == Transport::kRedis) return open_library_output(kRedis, to, context);
  return open_byte_output(to, context);
}

Result<void> Outputs::open(std::span<const StreamAddress> places,
                           const FrameOutputContext& context) {
  const std::size_t first = all_.size();
  all_.resize(first + places.size());
  for (const bool files : {false, true}) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      if ((places[i].transport == Transport::kFile) != files) continue;
      RETARGET_TRY_ASSIGN(all_[first + i], open_frame_output(places[i], context));
    }
  }
  return {};
}

void Outputs::take(const RobotFrame& frame) {
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

namespace {

constexpr int kMaxReports = 10;  // For intermittent outputs; further troubles are only counted.

class JsonFrameWriter final : public RobotFrameWriter {
 public:
  JsonFrameWriter(std::shared_ptr<const Robot> robot, double fps, std::vector<std::string> held)
      : robot_(std::move(robot)), fps_(fps), held_(std::move(held)) {
    for (const int joint : robot_->output_joints()) {
      addresses_.push_back(
          static_cast<std::size_t>(robot_->joints()[static_cast<std::size_t>(joint)].qpos_address));
    }
  }

  [[nodiscard]] std::string header() const override {
    std::vector<std::string> joints;
    for (const int joint : robot_->output_joints()) {
      joints.push_back(robot_->joints()[static_cast<std::size_t>(joint)].name);
    }
    nlohmann::ordered_json header = {{"robot", robot_->name()}, {"fps", fps_}, {"joints", joints}};
    if (!held_.empty()) {
      header["held"] = nlohmann::ordered_json::array({"root_position", "root_rotation"});
      for (const std::string& joint : held_) header["held"].push_back(joint);
    }
    return header.dump() + "\n";
  }

  void append(const RobotFrame& frame, std::string& bytes) override {
    auto out = std::back_inserter(bytes);
    fmt::format_to(out, "{{\"frame\":{},\"time\":{},\"state\":\"{}\",\"root_position\":[",
                   frame.index, frame.time, live_state_name(frame.state));
    const auto numbers = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        fmt::format_to(out, "{}{}", i == begin ? "" : ",", frame.qpos[i]);
      }
    };
    numbers(0, 3);
    fmt::format_to(out, "],\"root_rotation\":[");
    numbers(3, 7);
    fmt::format_to(out, "],\"joints\":[");
    for (std::size_t i = 0; i < addresses_.size(); ++i) {
      fmt::format_to(out, "{}{}", i == 0 ? "" : ",", frame.qpos[addresses_[i]]);
    }
    fmt::format_to(out, "]}}\n");
  }

 private:
  std::shared_ptr<const Robot> robot_;
  double fps_;
  std::vector<std::string> held_;
  std::vector<std::size_t> addresses_;
};

class CsvFrameWriter final : public RobotFrameWriter {
 public:
  explicit CsvFrameWriter(std::shared_ptr<const Robot> robot)
      : robot_(std::move(robot)), formatter_(*robot_) {}

  [[nodiscard]] std::string header() const override { return formatter_.header(); }
  void append(const RobotFrame& frame, std::string& bytes) override {
    formatter_.append_line(frame.qpos, bytes);
  }

 private:
  std::shared_ptr<const Robot> robot_;
  RobotCsvFormatter formatter_;
};

}  // namespace

void OutputAccount::report_trouble(std::string_view reason) {
  if (statistics_.is_closed) return;
  statistics_.last_error = printable(reason);
  if (std::exchange(in_trouble_, true)) return;
  dropped_before_ = statistics_.dropped;
  if (++reports_ > kMaxReports) return;
  tell_("output",
        fmt::format("{} does not accept robot frames: {}; retrying{}", statistics_.name,
                    statistics_.last_error,
                    reports_ == kMaxReports ? ". Further failures are only counted" : ""));
}

void OutputAccount::report_recovery() {
  if (!std::exchange(in_trouble_, false) || reports_ > kMaxReports) return;
  const auto dropped = statistics_.dropped - dropped_before_;
  tell_("output", fmt::format("{} accepts robot frames again; {} dropped", statistics_.name,
                              count_text(dropped, "frame")));
}

void OutputAccount::close(std::string_view reason) {
  if (std::exchange(statistics_.is_closed, true)) return;
  statistics_.last_error = printable(reason);
  tell_("output", fmt::format("{} no longer accepts robot frames: {}", statistics_.name,
                              statistics_.last_error));
}

std::string_view live_state_name(LiveState state) {
  static constexpr std::array<std::string_view, 4> kNames = {"waiting", "following", "holding",
                                                             "standing"};
  return kNames[static_cast<std::size_t>(state)];
}

std::unique_ptr<RobotFrameWriter> make_frame_writer(const std::string& format,
                                                    const std::string& file,
                                                    std::shared_ptr<const Robot> robot, double fps,
                                                    std::vector<std::string> held) {
  const bool csv = format == "csv" || (format.empty() && file.ends_with(".csv"));
  if (csv) return std::make_unique<CsvFrameWriter>(std::move(robot));
  return std::make_unique<JsonFrameWriter>(std::move(robot), fps, std::move(held));
}

}  // namespace retarget
