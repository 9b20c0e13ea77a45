// `retarget live`: converts a stream to robot frames until Ctrl-C, or plays a motion as a stream.

#include <fmt/format.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/option_name.h"
#include "retarget/option_table.h"
#include "retarget/os.h"
#include "retarget/plan.h"
#include "retarget/serve.h"
#include "retarget/serve_table.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

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

// Options of a player have no effect on a live run, and the other way round.
Result<void> check_player_use(const LiveArguments& arguments) {
  const ServeRequest& request = arguments.request;
  if (arguments.play.empty()) {
    if (!request.is_given("to") && !request.is_given("speed")) return {};
    return usage_failure(
        RETARGET_OPTION("to") " and " RETARGET_OPTION("speed") " require " RETARGET_OPTION("play"),
        "add " RETARGET_OPTION("play") " FILE, or use " RETARGET_OPTION(
            "output") " for robot frames");
  }
  PlayOptions used;
  HumanOptions human;
  OptionTable rows = player_table(used);
  append(rows, rows_for(OptionUse::kLive, human_table(human)));
  std::vector<std::string> unused;
  for (const std::string& name : request.given) {
    if (find_option(rows, name) == nullptr) unused.push_back(marked_option(name));
  }
  if (unused.empty()) return {};
  return usage_failure(
      RETARGET_OPTION("play") " only sends a motion, for another live run to receive",
      "omit " + list_names(unused));
}

Result<void> play_clip(const LiveArguments& arguments, Console& console) {
  // A missing file of an option is the user's error before the motion is.
  Options options_of_human;
  options_of_human.human = arguments.request.serve.pipeline.run.human;
  RETARGET_TRY(check_options(options_of_human));
  RETARGET_TRY_ASSIGN(const Clip clip, load_clip(arguments.play));
  PlayOptions options = arguments.player;
  options.human = arguments.request.serve.pipeline.run.human;
  options.data_folder = data_folder_of(arguments.common).value_or(std::string());
  const InterruptGuard guard;
  RETARGET_TRY_ASSIGN(const int frames,
                      play(clip, options, [] { return InterruptGuard::interrupted(); }));
  console.line("sent", fmt::format("{} of {}", frames, count_text(clip.frame_count(), "frame")));
  return {};
}

}  // namespace

Result<void> live(const LiveArguments& arguments, Console& console) {
  // A paused reader of standard error must not delay the stream; it misses what it does not read in time.
  console.write_with([writer = std::make_shared<MessageWriter>(os::kStandardError)](
                         std::string_view text) { writer->write(text); });
  if (arguments.list) return list_formats();
  RETARGET_TRY(check_player_use(arguments));
  if (!arguments.play.empty()) return play_clip(arguments, console);
  ServeRequest request = arguments.request;
  RETARGET_TRY(prepare_serve(request));
  RETARGET_TRY_ASSIGN(LoadedRobot loaded, load_robot(request.robot, arguments.common, console));
  RETARGET_TRY_ASSIGN(const RobotSetup robot,
                      retarget::set_up_robot(std::move(loaded), request.serve.pipeline.run));
  console.lines(robot.follow_lines());
  console.warn(robot.doubts, robot.loaded.robot->name());
  ServeControl control;
  control.is_stopped = [] { return InterruptGuard::interrupted(); };
  control.is_recalibrated = &RecalibrationSignal::take;
  control.tell = [&console](std::string_view label, std::string_view text) {
    console.line(label, text);
  };
  const InterruptGuard guard;
  const RecalibrationSignal recalibration;
  RETARGET_TRY_ASSIGN(const ServeSummary summary,
                      serve_request(robot, std::move(request), control));
  for (const auto& [label, text] : serve_summary_lines(summary)) console.line(label, text);
  return summary.written;
}

}  // namespace retarget::cli
