#pragma once

#include <string_view>

#include "io/motion_writers.h"
#include "retarget/options.h"

namespace retarget {

/// What is known of a format. Its name is in options/enum_names.h, what it holds in motion_io.h.
struct FormatFacts {
  MotionFormat format;
  std::string_view ending;       ///< Of its file; empty: a folder.
  std::string_view long_ending;  ///< Tells files of one motion apart.
  bool has_own_rate;             ///< That of trackers (TrackingOptions), not the motion's.
  MotionFiles (*write)(const RobotClip&, MotionFormat, const WriteMotionOptions&);
};

[[nodiscard]] const FormatFacts& format_facts(MotionFormat format);

}  // namespace retarget
