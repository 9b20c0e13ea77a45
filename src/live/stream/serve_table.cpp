#include "retarget/serve_table.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "live/stream/live_files.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/live_table.h"
#include "retarget/load.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Longer than any run, but catches typing errors.
constexpr double kMaxSeconds = 1e9;

// The solving options of a run, described for a stream, whose end is unknown.
OptionTable live_solve_table(SolveOptions& options) {
  OptionTable table = rows_for(OptionUse::kLive, solve_table(options));
  for (Option& row : table) {
    if (row.name != "method") continue;
    row.info.help =
        "fit: optimise feasibility, in each frame or over the latest frames (" RETARGET_OPTION(
            "mode") "); gmr: the published two-pass inverse kinematics, frame by frame";
  }
  return table;
}

Result<void> record_options(ServeRequest request) {
  const std::string folder = request.serve.record;
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (!request.skeleton.empty()) {
    RETARGET_TRY_ASSIGN(const auto bytes, read_file(request.skeleton));
    RETARGET_TRY(write_file(recorded_file(folder, request.skeleton), bytes.view()));
  }
  return write_file(recorded_file(folder, kRecordedOptions),
                    options_text(recorded_serve_table(request)));
}

}  // namespace

OptionTable recorded_serve_table(ServeRequest& request) {
  LivePipelineOptions& pipeline = request.serve.pipeline;
  OptionTable table = {
      option("input", request.serve.input, kInputGroup, "ADDRESS",
             "Source of frames: udp:PORT, tcp:PORT, HOST:PORT instead of the port to accept other "
             "computers, stdin; append ?format=NAME (docs/live.md)",
             {.basic = true}),
      option(
          "skeleton", request.skeleton, kInputGroup, "FILE",
          "Motion or skeleton of the performer, for streams without a skeleton or for calibration",
          {.basic = true}),
      option("calibrate", pipeline.calibrate, kInputGroup, "",
             "Calibrate from the file's or stream's skeleton, or from the performer's pose "
             "after " RETARGET_OPTION("after") " seconds; SIGUSR1 calibrates again",
             {.basic = true}),
      option("after", pipeline.calibrate_after_s, kInputGroup, "SECONDS",
             "Time from the first frame to the calibration pose", {.min = 0.0, .max = 600.0})};
  append(table, live_table(pipeline.live));
  table.push_back(
      option("pace", pipeline.pace, kLiveGroup, "",
             "clock: send a robot frame every 1/fps seconds; input: as fast as input arrives, by "
             "its timestamps; auto: input if stdin goes to files and stdout, otherwise clock"));
  table.push_back(
      option("plain", request.plain, kLiveGroup, "",
             "With " RETARGET_OPTION("mode") " frame: inverse kinematics only, without "
                                             "speed limits and floor and foot corrections"));
  append(table, rows_for(OptionUse::kLive, robot_table(request.robot)));
  append(table, live_solve_table(pipeline.run.solve));
  append(table, rows_for(OptionUse::kLive, human_table(pipeline.run.human)));
  return table;
}

OptionTable serve_table(ServeRequest& request) {
  ServeOptions& serve = request.serve;
  OptionTable table = recorded_serve_table(request);
  append(
      table,
      {option("output", serve.outputs, kOutputGroup, "ADDRESS,...",
              "Destination of robot frames: udp:PORT, udp:HOST:PORT, tcp:..., a file, - for "
              "standard output (the default); as JSON lines, or as CSV for files that end in .csv; "
              "zmq:PORT for SONIC, redis:PORT for TWIST2; append ?format=NAME "
              "(docs/live.md)",
              {.basic = true, .letter = "o"}),
       option("record", serve.record, kOutputGroup, "DIR",
              "Folder for a recording of the raw input and the output"),
       option("replay", serve.replay, kInputGroup, "DIR",
              "Replay a recorded folder instead of an input, with its options; the output is "
              "identical byte for byte"),
       option("seconds", serve.seconds, kLiveGroup, "S",
              "Stop after this time (default: stop on Ctrl-C)", {.min = 0.0, .max = kMaxSeconds}),
       option("silent", serve.silent_s, kLiveGroup, "S",
              "Stop after this time without input (default: never)",
              {.min = 0.0, .max = kMaxSeconds}),
       option("stats", serve.stats, kOutputGroup, "FILE",
              "Write statistics as JSON, one line per second; - writes standard output")});
  return noting_given(std::move(table), request.given);
}

OptionTable player_table(PlayOptions& options) {
  return {option("to", options.to, "Player", "ADDRESS",
                 "Destination: udp:PORT, tcp:PORT, stdout; append ?format=NAME", {.basic = true}),
          option("speed", options.speed, "Player", "N", "Speed factor; 0: as fast as possible",
                 {.min = 0.0, .max = 1000.0})};
}

bool ServeRequest::is_given(std::string_view name) const {
  return std::ranges::find(given, name) != given.end();
}

namespace {

// Options that a replay does not use, marked.
std::vector<std::string> options_of_no_replay(ServeRequest request) {
  ServeRequest usual;
  const OptionTable rows = serve_table(request);
  const std::vector<std::string> changed = changed_options(rows, serve_table(usual));
  std::vector<std::string> unused;
  for (const std::string& name : option_names(rows)) {
    if (name == "replay" || name == "output") continue;
    const bool is_changed = std::ranges::find(changed, name) != changed.end();
    if (is_changed || request.is_given(name)) unused.push_back(marked_option(name));
  }
  return unused;
}

Result<void> restore_recorded(ServeRequest& request) {
  const std::string& folder = request.serve.replay;
  const std::vector<std::string> unused = options_of_no_replay(request);
  const std::string file = recorded_file(folder, kRecordedOptions);
  RETARGET_TRY(load_options(file, recorded_serve_table(request), "the options of a live run"));
  if (!request.skeleton.empty()) request.skeleton = recorded_file(folder, request.skeleton);
  if (unused.empty()) return {};
  return usage_failure(RETARGET_OPTION("replay") " uses the input and the options of the recording",
                       "omit " + list_names(unused));
}

Result<void> check_use(const ServeRequest& request) {
  const LivePipelineOptions& pipeline = request.serve.pipeline;
  if (request.is_given("after") && pipeline.calibrate == LiveCalibration::kAuto) {
    return usage_failure(RETARGET_OPTION("after") " requires " RETARGET_OPTION("calibrate"),
                         "add " RETARGET_OPTION("calibrate") " tpose or npose");
  }
  return check_live_use(pipeline.live, pipeline.run, request.given);
}

}  // namespace

Result<void> prepare_serve(ServeRequest& request) {
  const ServeOptions& serve = request.serve;
  if (!serve.record.empty() && !serve.replay.empty()) {
    return usage_failure(
        RETARGET_OPTION("record") " and " RETARGET_OPTION("replay") " cannot be combined");
  }
  RETARGET_TRY(serve.replay.empty() ? check_use(request) : restore_recorded(request));
  if (request.robot.name.empty() && request.robot.model.empty()) {
    return usage_failure("a live run needs a robot: " RETARGET_OPTION(
                             "robot") " NAME or " RETARGET_OPTION("robot-xml") " FILE",
                         "for example " RETARGET_OPTION("robot") " g1 and " RETARGET_OPTION(
                             "input") " udp:1118?format=bvh");
  }
  RETARGET_TRY(check_robot_choice(request.robot));
  return check_config_choice(request.robot, request.serve.pipeline.run.solve);
}

Result<ServeSummary> serve_request(const RobotSetup& robot, ServeRequest request,
                                   const ServeControl& control) {
  ServeOptions& serve_options = request.serve;
  LivePipelineOptions& pipeline = serve_options.pipeline;
  if (!request.skeleton.empty()) {
    RETARGET_TRY_ASSIGN(serve_options.skeleton, load_skeleton(request.skeleton));
  }
  RETARGET_TRY(check_serve(serve_options));
  RETARGET_TRY(check_live_files(serve_options, robot));
  RETARGET_TRY_ASSIGN(pipeline.pace, chosen_pace(serve_options));
  if (!serve_options.record.empty()) RETARGET_TRY(record_options(request));
  if (request.plain) make_plain(pipeline.live);
  return serve(robot, serve_options, control);
}

std::vector<std::pair<std::string, std::string>> serve_summary_lines(const ServeSummary& summary) {
  const LiveStatistics& live = summary.live;
  const PipelineStatistics& packets = summary.packets;
  const LatencySummary& latency = summary.latency;
  std::vector<std::pair<std::string, std::string>> lines;
  lines.emplace_back(
      "packets",
      fmt::format("{}, {} malformed; frames {} lost, {} late, {} doubled, {} bad", packets.packets,
                  packets.malformed, live.lost, live.late, live.doubled, live.bad));
  if (summary.unused) {
    const Error& why = *summary.unused;
    lines.emplace_back("stream", why.hint.empty() ? why.message : why.message + "; " + why.hint);
  }
  lines.emplace_back("robot",
                     fmt::format("{}: {} held, {} limited in speed or acceleration; {}",
                                 count_text(live.robot_frames, "frame"), live.held, live.limited,
                                 count_text(live.interruptions, "interruption")));
  if (live.failed_steps > 0) {
    lines.emplace_back(
        "failed", count_text(live.failed_steps, "step") + " of the fit with non-finite numbers");
  }
  lines.emplace_back("latency", fmt::format("packet to robot frame p50 {} ms, p99 {} ms, max {} ms",
                                            number_text(1e3 * latency.p50_s, 3),
                                            number_text(1e3 * latency.p99_s, 3),
                                            number_text(1e3 * latency.max_s, 3)));
  for (const OutputStatistics& output : summary.outputs) {
    if (output.dropped == 0 && output.reconnects == 0) continue;
    lines.emplace_back(
        "output",
        fmt::format("{}: {} sent, {} dropped, {}; {}", output.name, output.sent, output.dropped,
                    count_text(output.reconnects, "reconnect"), output.last_error));
  }
  return lines;
}

}  // namespace retarget
