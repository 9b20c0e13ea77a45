#include "live/live_table.h"

#include "base/option_name.h"

namespace retarget {

OptionTable live_table(LiveOptions& options) {
  return {
      option(
          "mode", options.mode, kLiveGroup, "",
          "frame: each frame as it comes; lag: the fit of whole clips on the latest frames, which "
          "leave " OPTION("lag") " later",
          {.basic = true}),
      option("lag", options.lag_s, kLiveGroup, "SECONDS",
             "How old a frame is when it leaves, with " OPTION("mode") " lag: more is smoother",
             {.min = 0.0, .max = 60.0, .basic = true}),
      option("fps", options.fps, kLiveGroup, "N", "Robot frames per second, whatever comes",
             {.min = 1.0, .max = 1000.0, .basic = true}),
      option("delay", options.delay_s, kLiveGroup, "SECONDS",
             "Robot frames wait so long for theirs: with some 0.02 they come evenly from a network "
             "that does not",
             {.min = 0.0, .max = 10.0}),
      option("hold", options.hold_s, kLiveGroup, "SECONDS",
             "A stream that stalls is held so long; then the robot comes to stand",
             {.min = 0.0, .max = 1e6}),
      option("clock", options.clock, kLiveGroup, "",
             "Time of a frame: the sender's stamp, where it has one, or its arrival")};
}

}  // namespace retarget
