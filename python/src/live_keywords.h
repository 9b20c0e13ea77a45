#pragma once

#include <nanobind/nanobind.h>

#include "retarget/live.h"
#include "retarget/options.h"
#include "retarget/serve_table.h"

namespace retarget::python {

/// Options of live.
struct LiveKeywords {
  LiveOptions live;
  Options run;
  ServeRequest serve;  ///< Only `plain` is used.
};

/// Returns the counters by name.
[[nodiscard]] nanobind::dict described(const LiveStatistics& statistics);

}  // namespace retarget::python
