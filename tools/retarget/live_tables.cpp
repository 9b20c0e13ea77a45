// Option tables of `retarget live`.

#include "argument_tables.h"

#include <utility>

#include "declare_table.h"
#include "retarget/live_table.h"
#include "retarget/option_table.h"
#include "retarget/serve.h"

namespace retarget::cli {
namespace {

OptionTable pipeline_rows(LiveArguments& arguments) {
  LivePipelineOptions& pipeline = arguments.serve.pipeline;
  OptionTable table = {
      option("input", arguments.serve.input, kInputGroup, "ADDRESS",
             "Source of frames: udp:PORT, tcp:PORT, HOST:PORT instead of the port to accept other "
             "computers, stdin; append ?format=NAME (--list)",
             {.basic = true}),
      option("skeleton", arguments.skeleton, kInputGroup, "FILE",
             "A motion or skeleton of the performer, for streams without a skeleton or for "
             "calibration",
             {.basic = true}),
      option("calibrate", pipeline.calibrate, kInputGroup, "",
             "Calibrate from the file's or stream's skeleton, or from the performer's pose after "
             "--after seconds; SIGUSR1 calibrates again",
             {.basic = true}),
      option("after", pipeline.calibrate_after_s, kInputGroup, "SECONDS",
             "Time from the first frame to the calibration pose", {.min = 0.0, .max = 600.0})};
  append(table, live_table(pipeline.live));
  table.push_back(
      option("pace", pipeline.pace, kLiveGroup, "",
             "clock: send a robot frame every 1/fps seconds; input: as fast as input arrives, by "
             "its timestamps; auto: input from stdin to files and stdout, otherwise clock"));
  table.push_back(option("plain", arguments.plain, kLiveGroup, "",
                         "With --mode frame: inverse kinematics only, without speed limits and "
                         "without handling of floor and feet"));
  return table;
}

}  // namespace

OptionTable live_run_table(LiveArguments& arguments) {
  OptionTable table = pipeline_rows(arguments);
  append(table, rows_for(OptionUse::kLive, robot_table(arguments.run.run.robot)));
  append(table, rows_for(OptionUse::kLive, solve_table(arguments.run.run.options.solve)));
  append(table, rows_for(OptionUse::kLive, human_table(arguments.run.run.options.human)));
  return table;
}

OptionTable live_command_table(LiveArguments& arguments) {
  ServeOptions& serve = arguments.serve;
  OptionTable table = live_run_table(arguments);
  append(
      table,
      {option("output", serve.outputs, kOutputGroup, "ADDRESS,...",
              "Destination of robot frames: udp:PORT, udp:HOST:PORT, tcp:..., a file, - for "
              "standard output (the default); as JSON lines, or as CSV for files that end in .csv; "
              "zmq:PORT for SONIC, redis:PORT for TWIST2; append ?format=NAME (--list)",
              {.basic = true, .letter = "o"}),
       option("record", serve.record, kOutputGroup, "DIR",
              "Folder for a recording of the raw input and the output"),
       option("replay", serve.replay, kInputGroup, "DIR",
              "Replay a recorded folder instead of an input, with its options; the output is "
              "identical byte for byte"),
       option("seconds", serve.seconds, kLiveGroup, "S",
              "Stop after this time (default: stop on Ctrl-C)", {.min = 0.0, .max = kMaxTime}),
       option("silent", serve.silent_s, kLiveGroup, "S",
              "Stop after this time without input (default: never)", {.min = 0.0, .max = kMaxTime}),
       option("stats", serve.stats, kOutputGroup, "FILE",
              "Write statistics as JSON, one line per second; - writes standard output"),
       option("play", arguments.play, "Player", "FILE",
              "Only send this motion to --to, as the capture system would", {.basic = true}),
       option("to", arguments.player.to, "Player", "ADDRESS",
              "Destination: udp:PORT, tcp:PORT, stdout; append ?format=NAME", {.basic = true}),
       option("speed", arguments.player.speed, "Player", "N",
              "Speed factor; 0: as fast as possible", {.min = 0.0, .max = 1000.0}),
       option("list", arguments.list, kInputGroup, "", "List the input and output formats and exit",
              {.basic = true})});
  append(table, common_table(arguments.run.common));
  return table;
}

}  // namespace retarget::cli
