// The options of `retarget live`.

#include "argument_tables.h"

#include <array>
#include <utility>

#include "declare_table.h"
#include "live/live_table.h"
#include "options/enum_names.h"
#include "options/run_tables.h"
#include "stream/live_pipeline.h"

namespace retarget {

template <>
inline constexpr auto kEnumNames<LiveCalibration> =
    std::to_array<NamedValue<LiveCalibration>>({{LiveCalibration::kAuto, "auto"},
                                                {LiveCalibration::kTpose, "tpose"},
                                                {LiveCalibration::kNpose, "npose"}});

}  // namespace retarget

namespace retarget::cli {
namespace {

OptionTable pipeline_rows(LiveArguments& arguments) {
  LivePipelineOptions& pipeline = arguments.serve.pipeline;
  OptionTable table = {
      option("input", arguments.serve.input, kInputGroup, "ADDRESS",
             "Where frames come from: udp:PORT, tcp:PORT, HOST:PORT in place of the port to be "
             "reached from elsewhere, stdin; ?format=NAME behind it (--list)",
             {.basic = true}),
      option("skeleton", arguments.skeleton, kInputGroup, "FILE",
             "A motion of the body that will move, or its skeleton: of streams that tell none, or "
             "to calibrate by",
             {.basic = true}),
      option("calibrate", pipeline.calibrate, kInputGroup, "",
             "By what the file or the stream says of the body, or by the pose that the performer "
             "has when --after seconds have passed; SIGUSR1 asks for it again",
             {.basic = true}),
      option("after", pipeline.calibrate_after_s, kInputGroup, "SECONDS",
             "From the first frame to the pose of --calibrate", {.min = 0.0, .max = 600.0})};
  append(table, live_table(pipeline.live));
  table.push_back(option("plain", arguments.plain, kLiveGroup, "",
                         "With --mode frame: the inverse kinematics alone; no limits of speed, and "
                         "neither floor nor feet are looked after"));
  return table;
}

}  // namespace

OptionTable live_run_table(LiveArguments& arguments) {
  OptionTable table = pipeline_rows(arguments);
  append(table, robot_table(arguments.run.run.robot));
  append(table, without(solve_table(arguments.run.run.options.solve), {"with", "window"}));
  append(table, without(human_table(arguments.run.run.options.human), {"tpose-frame"}));
  return table;
}

OptionTable live_command_table(LiveArguments& arguments) {
  ServeOptions& serve = arguments.serve;
  OptionTable table = live_run_table(arguments);
  append(
      table,
      {option("output", serve.outputs, kOutputGroup, "ADDRESS,...",
              "Where robot frames go: udp:PORT, udp:HOST:PORT, tcp:..., a file, - for standard "
              "output (the default); as JSON lines, files that end in .csv as CSV; zmq:PORT for "
              "SONIC, redis:PORT for TWIST2; ?format=NAME behind it (--list)",
              {.basic = true, .letter = "o"}),
       option("record", serve.record, kOutputGroup, "DIR",
              "Folder for what came, as it came, and what left"),
       option("replay", serve.replay, kInputGroup, "DIR",
              "Such a folder in place of an input, with its options: gives the same bytes again"),
       option("seconds", serve.seconds, kLiveGroup, "S", "End after so long (default: Ctrl-C ends)",
              {.min = 0.0, .max = kMaxTime}),
       option("silent", serve.silent_s, kLiveGroup, "S",
              "End when nothing came for so long (default: it goes on)",
              {.min = 0.0, .max = kMaxTime}),
       option("play", arguments.play, "Player", "FILE",
              "Send this motion to --to as its capture would have, and do nothing else",
              {.basic = true}),
       option("to", arguments.player.to, "Player", "ADDRESS",
              "Where it is sent: udp:PORT, tcp:PORT, stdout; ?format=NAME behind it",
              {.basic = true}),
       option("speed", arguments.player.speed, "Player", "N",
              "Times its own speed; 0: as fast as it goes", {.min = 0.0, .max = 1000.0}),
       option("list", arguments.list, kInputGroup, "",
              "List the formats of inputs and outputs, and end", {.basic = true})});
  append(table, common_table(arguments.run.common));
  return table;
}

}  // namespace retarget::cli
