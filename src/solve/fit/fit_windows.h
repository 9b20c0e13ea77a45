#pragma once

#include <vector>

#include "retarget/options.h"
#include "solve/fit/fit_clip.h"

namespace retarget {

/// The division of a clip into windows. It depends only on the clip and the options, not on the
/// number of threads.
struct FitWindows {
  std::vector<FitWindow> windows;  ///< Contiguous; every frame is in one.
  std::vector<FitWindow> seams;    ///< One over each window border; may be empty.
  /// One entry per window: number of leading frames that the first stage must have solved before
  /// the window can start. They include all frames of the contacts that the window cuts.
  std::vector<int> frames_needed;
};

/// Plans windows of about `options.window` seconds. Their borders avoid contacts, because the
/// anchor of a contact that a border cuts cannot move.
[[nodiscard]] FitWindows plan_windows(const FitClip& clip, const FitOptions& options);

}  // namespace retarget
