#pragma once

#include <nanobind/nanobind.h>

#include "retarget/live.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/serve_table.h"

namespace retarget::python {

/// Options of live.
struct LiveKeywords {
  LiveOptions live;
  Options run;
  ServeRequest serve;  ///< Only `plain` is used.
};

/// Returns the options of live except the robot and the rate.
[[nodiscard]] OptionTable live_keywords(LiveKeywords& options);

/// Returns the counters by name.
[[nodiscard]] nanobind::dict described(const LiveStatistics& statistics);

}  // namespace retarget::python
