#include "retarget/live_table.h"

#include "retarget/option_name.h"

namespace retarget {

namespace {

// An option that bounds the robot's motion.
Option bound(const char* name, double& value, const char* unit, const char* help) {
  return option(name, value, kLiveGroup, unit, help, {.min = 1e-3, .max = 1e6});
}

}  // namespace

OptionTable live_table(LiveOptions& options) {
  return {option("mode", options.mode, kLiveGroup, "",
                 "frame: solve every frame immediately; lag: apply the fit of whole clips to the "
                 "latest frames and output them " RETARGET_OPTION("lag") " later",
                 {.basic = true}),
          option("lag", options.lag_s, kLiveGroup, "SECONDS",
                 "Delay of a frame at output, with " RETARGET_OPTION(
                     "mode") " lag: a longer delay is smoother",
                 {.min = 0.0, .max = 60.0, .basic = true}),
          option("fps", options.fps, kLiveGroup, "N",
                 "Robot frames per second, independent of the input rate",
                 {.min = 1.0, .max = 1000.0, .basic = true}),
          option("delay", options.delay_s, kLiveGroup, "SECONDS",
                 "Minimum delay of the human, to absorb network jitter", {.min = 0.0, .max = 10.0}),
          option("hold", options.hold_s, kLiveGroup, "SECONDS",
                 "Hold the last pose this long when the stream stalls, then return to standing",
                 {.min = 0.0, .max = 1e6}),
          option("clock", options.clock, kLiveGroup, "",
                 "Time of a frame: the sender's timestamp if present, or its arrival time"),
          bound("max-root-speed", options.limits.root_speed, "M/S", "Maximum root speed"),
          bound("max-turn-speed", options.limits.turn_speed, "RAD/S", "Maximum root turn rate"),
          bound("max-joint-acceleration", options.limits.joint_acceleration, "RAD/S2",
                "Maximum joint acceleration"),
          bound("max-root-acceleration", options.limits.root_acceleration, "M/S2",
                "Maximum root acceleration"),
          bound("max-turn-acceleration", options.limits.turn_acceleration, "RAD/S2",
                "Maximum angular acceleration of the root"),
          bound("resume-joint-speed", options.limits.resume_joint_speed, "RAD/S",
                "Maximum joint speed right after a gap, a teleport or a new calibration"),
          bound("resume-root-speed", options.limits.resume_root_speed, "M/S",
                "Maximum root speed after such an interruption"),
          bound("resume-turn-speed", options.limits.resume_turn_speed, "RAD/S",
                "Maximum root turn rate after such an interruption"),
          bound("resume-time", options.limits.resume_s, "SECONDS",
                "Time until the full speeds are allowed again")};
}

}  // namespace retarget
