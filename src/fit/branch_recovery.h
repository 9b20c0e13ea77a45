#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fit/fit_clip.h"
#include "fit/fit_model.h"
#include "retarget/options.h"

namespace retarget {

/// A limb that was taken to another branch.
struct RecoveredLimb {
  std::string limb;                            ///< `left arm`
  int begin = 0, end = 0;                      ///< Frames [begin, end).
  double cost_before = 0.0, cost_after = 0.0;  ///< Of tracking on the limb, sums over them.
};

/// What was found in a clip.
struct BranchRecovery {
  std::vector<RecoveredLimb> limbs;  ///< By limb, in time.
  bool stopped = false;              ///< By the caller: the clip is half done.

  /// A sentence for each limb.
  [[nodiscard]] std::vector<std::string> notes() const;
};

/// Looks through a fitted clip for arms and legs that hang on the wrong branch, and takes them to
/// another one where all terms together then cost clearly less (docs/fit.md). All other frames
/// stay as they are, bit for bit.
/// @param keep_going  asked now and then; false stops.
[[nodiscard]] BranchRecovery recover_branches(const FitModel& model, const FitOptions& options,
                                              FitClip& clip,
                                              const std::function<bool()>& keep_going);

}  // namespace retarget
