#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "live/session/floor_finder.h"
#include "live/session/foot_holder.h"
#include "live/session/lag_fit.h"
#include "live/session/live_targets.h"
#include "retarget/live.h"

namespace retarget {

/// The state of a stream that depends on the current body.
struct LiveBody {
  LiveBody(std::unique_ptr<LiveTargets> made, const LiveOptions& options, double frame_time);

  /// Declares a discontinuity: the next frame is unrelated to earlier ones.
  /// @param settles  the next pose is solved from several starts (LiveTargets::settle_next).
  void restart(bool settles);

  std::unique_ptr<LiveTargets> targets;
  std::vector<LiveFoot> feet;
  FloorFinder floor;
  FootHolder holder;
  std::optional<LagFit> lag;
};

}  // namespace retarget
