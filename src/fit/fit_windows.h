#pragma once

#include <vector>

#include "fit/fit_clip.h"
#include "retarget/options.h"

namespace retarget {

/// How a clip is cut. It hangs on the clip and on options alone, never on threads.
struct FitWindows {
  std::vector<FitWindow> windows;  ///< Side by side, every frame in one.
  std::vector<FitWindow> seams;    ///< Over the border of each window with the next; or none.
  /// By window: how many of the clip's first frames must have their start, and with that the
  /// places of all contacts that it sees, before it can be solved.
  std::vector<int> frames_needed;
};

/// Windows of about `options.window` seconds that end where few contacts are under way, for the
/// place of one that a window cuts cannot move.
[[nodiscard]] FitWindows plan_windows(const FitClip& clip, const FitOptions& options);

}  // namespace retarget
