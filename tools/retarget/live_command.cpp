// `retarget live`: converts a stream to robot frames until Ctrl-C, or plays a motion as a stream.

#include <fmt/format.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "argument_tables.h"
#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/serve.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecordedOptions = "live.json";

// Signal handlers can only access globals.
volatile std::sig_atomic_t recalibration_asked = 0;

class RecalibrationSignal {
 public:
  RecalibrationSignal() {
    recalibration_asked = 0;
    struct sigaction action {};
    action.sa_handler = [](int) { recalibration_asked = 1; };
    sigemptyset(&action.sa_mask);
    ::sigaction(SIGUSR1, &action, &old_);
  }
  ~RecalibrationSignal() { ::sigaction(SIGUSR1, &old_, nullptr); }
  RecalibrationSignal(const RecalibrationSignal&) = delete;
  RecalibrationSignal& operator=(const RecalibrationSignal&) = delete;

  [[nodiscard]] static bool take() {
    if (recalibration_asked == 0) return false;
    recalibration_asked = 0;
    return true;
  }

 private:
  struct sigaction old_ {};
};

Result<void> list_formats() {
  std::string text = "inputs\n";
  for (const InputFormat& format : input_formats()) {
    const std::string port = format.port > 0 ? fmt::format("usual port {}", format.port) : "";
    text += fmt::format("  {:<8} {}{}{}\n", format.name, format.description,
                        port.empty() ? "" : "; ", port);
  }
  text += "outputs\n";
  for (const OutputFormat& format : output_formats()) {
    text += fmt::format("  {:<8} {}: {}", format.name, format.description, format.places);
    if (format.port > 0) text += fmt::format("; usual port {}", format.port);
    if (!format.lacks.empty()) text += fmt::format("; this build lacks {}", format.lacks);
    text += '\n';
  }
  return write_file("-", text);
}

Result<void> play_clip(const LiveArguments& arguments, Console& console) {
  RETARGET_TRY_ASSIGN(const Clip clip, load_clip(arguments.play));
  PlayOptions options = arguments.player;
  options.human = arguments.run.run.options.human;
  options.data_folder = data_folder_of(arguments.run.common).value_or(std::string());
  const InterruptGuard guard;
  RETARGET_TRY_ASSIGN(const int frames,
                      play(clip, options, [] { return InterruptGuard::interrupted(); }));
  console.line("sent", fmt::format("{} of {}", frames, count_text(clip.frame_count(), "frame")));
  return {};
}

// Restores the options and the skeleton of a recording.
Result<void> take_recorded(LiveArguments& arguments) {
  const fs::path folder(arguments.serve.replay);
  const std::string file = (folder / kRecordedOptions).string();
  RETARGET_TRY(load_options(file, live_run_table(arguments), "the options of a live run"));
  if (!arguments.skeleton.empty()) {
    arguments.skeleton = (folder / fs::path(arguments.skeleton).filename()).string();
  }
  return {};
}

Result<void> record_options(const LiveArguments& given) {
  LiveArguments arguments = given;
  const fs::path folder(arguments.serve.record);
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (!arguments.skeleton.empty()) {
    const fs::path copy = folder / fs::path(arguments.skeleton).filename();
    RETARGET_TRY_ASSIGN(const auto bytes, read_file(arguments.skeleton));
    RETARGET_TRY(write_file(copy.string(), bytes.view()));
  }
  return write_file((folder / kRecordedOptions).string(), options_text(live_run_table(arguments)));
}

Result<void> check_usage(const LiveArguments& arguments) {
  const Run& run = arguments.run.run;
  if (run.robot.name.empty() && run.robot.model.empty()) {
    return usage_failure("a live run needs a robot: --robot NAME or --robot-xml FILE",
                         "for example: retarget live --robot g1 --input udp:1118?format=bvh");
  }
  if (!arguments.serve.record.empty() && !arguments.serve.replay.empty()) {
    return usage_failure("--record and --replay cannot be combined");
  }
  return check_robot_choice(run.robot);
}

void summarise(const ServeSummary& summary, Console& console) {
  const LiveStatistics& live = summary.live;
  const PipelineStatistics& packets = summary.packets;
  console.line(
      "packets",
      fmt::format("{}, {} malformed; frames {} lost, {} late, {} doubled, {} bad", packets.packets,
                  packets.malformed, live.lost, live.late, live.doubled, live.bad));
  console.line("robot", fmt::format("{}: {} held, {} limited in speed or acceleration; {}",
                                    count_text(live.robot_frames, "frame"), live.held, live.limited,
                                    count_text(live.interruptions, "interruption")));
  if (live.failed_steps > 0) {
    console.line("failed",
                 count_text(live.failed_steps, "step") + " of the fit with non-finite numbers");
  }
  const LatencySummary& latency = summary.latency;
  console.line("latency",
               fmt::format("packet to robot frame p50 {} ms, p99 {} ms, max {} ms",
                           number_text(1e3 * latency.p50_s, 3), number_text(1e3 * latency.p99_s, 3),
                           number_text(1e3 * latency.max_s, 3)));
  for (const OutputStatistics& output : summary.outputs) {
    if (output.dropped == 0 && output.reconnects == 0) continue;
    console.line("output", fmt::format("{}: {} sent, {} dropped, {}; {}", output.name, output.sent,
                                       output.dropped, count_text(output.reconnects, "reconnect"),
                                       output.last_error));
  }
}

}  // namespace

Result<void> live(const LiveArguments& given, Console& console) {
  console.never_wait();
  LiveArguments arguments = given;
  if (arguments.list) return list_formats();
  if (!arguments.play.empty()) return play_clip(arguments, console);
  if (!arguments.serve.replay.empty()) RETARGET_TRY(take_recorded(arguments));
  RETARGET_TRY(check_usage(arguments));
  RETARGET_TRY_ASSIGN(const RobotSetup robot,
                      set_up_robot(arguments.run.run, arguments.run.common, console));
  ServeOptions& serve_options = arguments.serve;
  LivePipelineOptions& pipeline = serve_options.pipeline;
  pipeline.run = arguments.run.run.options;
  if (arguments.plain) {
    pipeline.live.limit_speeds = pipeline.live.floor = pipeline.live.hold_feet = false;
  }
  if (!arguments.skeleton.empty()) {
    RETARGET_TRY_ASSIGN(serve_options.skeleton, load_skeleton(arguments.skeleton));
  }
  RETARGET_TRY_ASSIGN(pipeline.pace, chosen_pace(serve_options));
  console.lines(robot.follow_lines());
  if (!serve_options.record.empty()) RETARGET_TRY(record_options(arguments));
  ServeControl control;
  control.is_stopped = [] { return InterruptGuard::interrupted(); };
  control.is_recalibrated = &RecalibrationSignal::take;
  control.tell = [&console](std::string_view label, std::string_view text) {
    console.line(label, text);
  };
  const InterruptGuard guard;
  const RecalibrationSignal recalibration;
  RETARGET_TRY_ASSIGN(const ServeSummary summary, serve(robot, serve_options, control));
  summarise(summary, console);
  return summary.written;
}

}  // namespace retarget::cli
